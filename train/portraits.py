"""A folder of photographs as training data, without any truth."""

import csv
import io
import sys
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jsonargparse.typing import NonNegativeInt, PositiveInt, restricted_number_type
from lightning import LightningDataModule
from lightning.pytorch.utilities import CombinedLoader, rank_zero_only
from numpy.typing import NDArray
from torch.utils.data import DataLoader, Dataset

from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.images import (
    find_face,
    frame_head,
    linear_to_srgb,
    read_photo,
    resize,
    segment_skin,
    srgb_to_linear,
    to_uint8,
)
from train.batch import Batch
from train.guards import listed
from train.stream import StreamLoader, seen_samples
from train.synthetic.faces import Drawn, SyntheticFaces

SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp")
Share = restricted_number_type("Share", float, [(">=", 0), ("<", 1)])

EXPOSURE_SD, WHITE_BALANCE_SD = 0.4, 0.03
"""How much photographs vary in training, in logarithms: all of it, and red and blue to green."""


class Crop(NamedTuple):
    """A face cut out of a photograph: uint8 sRGB [size, size, 3] and its skin mask, uint8."""

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]


class Pair(NamedTuple):
    """A crop seen twice, each time brighter or darker, warmer or colder."""

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    again: NDArray[np.uint8]


class Crops(Dataset[Pair]):
    """Pairs in an endless stream: every epoch has all crops, shuffled, mirrored, and varied by its
    own number and the seed.
    """

    def __init__(self, crops: list[Crop], seed: int):
        self.crops = crops
        self.seed = seed

    def __len__(self) -> int:
        return len(self.crops)

    def __getitem__(self, index: int) -> Pair:
        epoch, place = divmod(index, len(self.crops))
        lot = np.random.default_rng([self.seed, epoch])
        order = lot.permutation(len(self.crops))
        mirrored = lot.random(len(self.crops)) < 0.5
        crop = self.crops[order[place]]
        crop = Crop(*(part[:, ::-1].copy() for part in crop)) if mirrored[place] else crop
        draw = np.random.default_rng([self.seed, epoch, place])
        return Pair(*varied(crop, draw), varied(crop, draw).photograph)


def varied(crop: Crop, draw: np.random.Generator) -> Crop:
    """The crop under another exposure, which clips as a camera does, and white balance."""
    red, blue = draw.normal(0, WHITE_BALANCE_SD, 2)
    gain = np.exp(draw.normal(0, EXPOSURE_SD) + np.array([red, 0, blue]))
    levels = srgb_to_linear(np.arange(256, dtype=np.uint8))
    table = to_uint8(linear_to_srgb(levels[:, None] * gain))
    return crop._replace(photograph=table[crop.photograph, np.arange(3)])


class Portraits(LightningDataModule):
    """Photographs of faces, found, cropped and masked by `skinnet.images.faces`.

    Unreadable pictures and pictures without a face are skipped, counted, and listed in
    `skipped.csv` of the run. Every step also sees a batch of `twin`, so that the maps keep their
    meaning. In training each photograph is shown twice in different exposure and white balance, so
    that what is read of it can be held to be the same.

    Args:
        folder: of the photographs, searched with its subfolders.
        size: side of the square crops in pixels.
        batch_size: photographs in a batch of each process.
        val_share: share of the photographs that is kept for validation.
        unreadable_share: share of the pictures that may be unreadable; with more, training does not
            start.
        seed: of the order, the variation and the choice of validation photographs.
        twin: heads of the same size with all ground truth, to train on beside the photographs.
    """

    def __init__(
        self,
        folder: str,
        size: PositiveInt = 128,
        batch_size: PositiveInt = 16,
        val_share: Share = 0.1,  # type: ignore[valid-type]
        unreadable_share: Share = 0.1,  # type: ignore[valid-type]
        seed: NonNegativeInt = 0,
        twin: SyntheticFaces | None = None,
    ):
        super().__init__()
        self.folder = Path(folder)
        self.size = size
        self.batch_size = batch_size
        self.val_share = val_share
        self.unreadable_share = unreadable_share
        self.seed = seed
        self.twin = twin or SyntheticFaces(size=size, batch_size=batch_size)
        self.crops: dict[str, list[Crop]] = {}

    @property
    def described(self) -> str:
        """What a model card says of these data."""
        return f"{len(self.crops['train'])} photographs and {self.twin.described}"

    def prepare_data(self) -> None:
        """Cast the heads of the twin that are missing, once there are photographs to be used."""
        if not self.crops:
            self._find()
        self.twin.trainer = self.trainer
        self.twin.prepare_data()

    def setup(self, stage: str) -> None:
        """Find the faces, and read the heads of the twin that a stage needs."""
        if not self.crops:
            self._find()
        self.twin.trainer = self.trainer
        self.twin.setup(stage)

    def _find(self) -> None:
        # Not when it is made: the parser would hide the sentence in its own.
        if self.twin.size != self.size:
            raise InputError(
                f"Photographs are cut to {self.size} pixels and the twin's pictures have "
                f"{self.twin.size}; give --data.init_args.size and --data.init_args.twin.size "
                "the same number."
            )
        crops, skipped = find_crops(self.folder, self.size, self.unreadable_share)
        if self.trainer is not None and self.trainer.is_global_zero:
            write_skipped(skipped, Path(self.trainer.default_root_dir) / "skipped.csv")
        order = np.random.default_rng(self.seed).permutation(len(crops))
        kept = max(1, round(self.val_share * len(crops)))
        if len(crops) <= kept:
            raise InputError(f"{self.folder} has {len(crops)} usable photographs; two are needed.")
        self.crops = {
            "val": [crops[index] for index in order[:kept]],
            "train": [crops[index] for index in order[kept:]],
        }

    def train_dataloader(self) -> CombinedLoader:
        crops = Crops(self.crops["train"], self.seed)
        steps = max(len(crops) // self.batch_size, 1)
        seen = partial(seen_samples, self.trainer, self.batch_size)
        loaders = {
            "portraits": StreamLoader(crops, self.batch_size, steps * self.batch_size, seen),
            "twin": self.twin.stream(steps, self.trainer),
        }
        return CombinedLoader(loaders, "min_size")

    def val_dataloader(self) -> CombinedLoader:
        return self._fixed(self.twin.val_dataloader())

    def test_dataloader(self) -> CombinedLoader:
        return self._fixed(self.twin.test_dataloader())

    def _fixed(self, twin: DataLoader[Drawn]) -> CombinedLoader:
        """The photographs kept for validation, as they are, beside pictures of the twin; whichever
        are fewer come again.
        """
        portraits: DataLoader[Crop] = DataLoader(self.crops["val"], self.batch_size)  # type: ignore[arg-type]
        return CombinedLoader({"portraits": portraits, "twin": twin}, "max_size_cycle")

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> dict[str, Batch]:
        photograph, mask, *again = (part.float() / 255 for part in batch["portraits"])
        shown = torch.cat([photograph, *again]).movedim(-1, 1)
        masks = torch.cat([mask] * (1 + len(again)))
        twin = self.twin.on_after_batch_transfer(batch["twin"], dataloader_idx)
        return {"portraits": Batch(shown, masks, twice=bool(again)), "twin": twin}


class Skipped(NamedTuple):
    """A picture that training goes without, and why, in words."""

    path: Path
    reason: str
    readable: bool


def find_crops(
    folder: Path, size: int, unreadable_share: float = 0.1
) -> tuple[list[Crop], list[Skipped]]:
    """The faces of all pictures in a folder, in the order of their names, and what was skipped.

    Raises `InputError` if there is no folder or no picture in it, if more than `unreadable_share`
    of the pictures cannot be read, or if none shows a face.
    """
    pictures = find_pictures(folder)
    found = [_crop(path, size) for path in pictures]
    crops = [each for each in found if isinstance(each, Crop)]
    skipped = [each for each in found if isinstance(each, Skipped)]
    unreadable = [str(each.path) for each in skipped if not each.readable]
    if len(unreadable) > unreadable_share * len(pictures):
        raise InputError(_too_many(folder, unreadable, len(pictures), unreadable_share))
    if not crops:
        raise InputError(
            f"{folder} holds no photograph with a face in it ({len(pictures)} pictures looked at)."
        )
    _report(folder, len(crops), unreadable, len(skipped) - len(unreadable))
    return crops, skipped


def find_pictures(folder: Path) -> list[Path]:
    """Pictures in a folder and its subfolders, by name; `InputError` if there is none."""
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder; give the folder of your photographs.")
    pictures = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES)
    if not pictures:
        raise InputError(
            f"{folder} holds no photographs; those are files in {', '.join(SUFFIXES)}."
        )
    return pictures


def write_skipped(skipped: list[Skipped], path: Path) -> None:
    """Write a table of the pictures that were skipped; none are a table without rows."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("picture", "reason"))
    rows.writerows((each.path, each.reason) for each in skipped)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text.getvalue())


def _too_many(folder: Path, unreadable: list[str], pictures: int, allowed: float) -> str:
    return (
        f"{len(unreadable)} of {pictures} pictures in {folder} cannot be read "
        f"({len(unreadable) / pictures:.0%}, and {allowed:.0%} may): {listed(unreadable, 5)}. "
        "Repair or remove them, or allow more with --data.init_args.unreadable_share."
    )


@rank_zero_only
def _report(folder: Path, faces: int, unreadable: list[str], faceless: int) -> None:
    said = f"{folder}: {faces} faces, {len(unreadable) + faceless} pictures skipped"
    parts = [f"{faceless} without a face"] if faceless else []
    if unreadable:
        parts.append(f"{len(unreadable)} unreadable: {listed(unreadable, 10)}")
    print(f"{said} ({'; '.join(parts)})" if parts else said, file=sys.stderr)


def _crop(path: Path, size: int) -> Crop | Skipped:
    try:
        photo = read_photo(path)
    except InputError as error:
        return Skipped(path, str(error), readable=False)
    face = find_face(photo)
    if face is None:
        return Skipped(path, "No face was found in it.", readable=True)
    box = frame_head(face, photo.shape[1], photo.shape[0])
    mask = segment_skin(photo, face)[box.slices]
    scale = size / max(box.width, box.height)
    width, height = max(1, round(box.width * scale)), max(1, round(box.height * scale))
    pad = ((0, size - height), (0, size - width))
    return Crop(
        np.pad(resize(photo[box.slices], width, height), (*pad, (0, 0)), mode="edge"),
        np.pad((255 * resize(mask, width, height)).round().astype(np.uint8), pad),
    )
