"""A folder of photographs as training data, without any truth."""

import sys
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jsonargparse.typing import NonNegativeInt, PositiveInt, restricted_number_type
from lightning import LightningDataModule
from lightning.pytorch.utilities import CombinedLoader
from numpy.typing import NDArray
from torch.utils.data import DataLoader, Dataset

from skinnet.errors import InputError
from skinnet.faces import crop_box, find_face, resize, skin_mask
from skinnet.images import read_photo
from train.batch import Batch
from train.stream import StreamLoader
from train.synthetic import SyntheticFaces, seen_samples

SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp")
Share = restricted_number_type("Share", float, [(">=", 0), ("<", 1)])


class Crop(NamedTuple):
    """A face cut out of a photograph: uint8 sRGB [size, size, 3] and its skin mask, uint8."""

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]


class Crops(Dataset[Crop]):
    """Crops in an endless stream: every epoch has all of them, shuffled and mirrored by its own
    number and the seed."""

    def __init__(self, crops: list[Crop], seed: int):
        self.crops = crops
        self.seed = seed

    def __len__(self) -> int:
        return len(self.crops)

    def __getitem__(self, index: int) -> Crop:
        epoch, place = divmod(index, len(self.crops))
        lot = np.random.default_rng([self.seed, epoch])
        order = lot.permutation(len(self.crops))
        mirrored = lot.random(len(self.crops)) < 0.5
        crop = self.crops[order[place]]
        return Crop(*(part[:, ::-1].copy() for part in crop)) if mirrored[place] else crop


class Portraits(LightningDataModule):
    """Photographs of faces, found, cropped and masked by `skinnet.faces`.

    Unreadable pictures and pictures without a face are skipped and counted. Every step also sees
    a batch of `synthetic`, so that the maps keep their meaning.

    Args:
        folder: of the photographs, searched with its subfolders.
        size: side of the square crops in pixels.
        batch_size: photographs in a batch.
        val_share: share of the photographs that is kept for validation.
        seed: of the order, the mirroring and the choice of validation photographs.
        synthetic: synthetic faces of the same size to train on beside the photographs.
    """

    def __init__(
        self,
        folder: str,
        size: PositiveInt = 128,
        batch_size: PositiveInt = 16,
        val_share: Share = 0.1,  # type: ignore[valid-type]
        seed: NonNegativeInt = 0,
        synthetic: SyntheticFaces | None = None,
    ):
        super().__init__()
        self.folder = Path(folder)
        self.size = size
        self.batch_size = batch_size
        self.val_share = val_share
        self.seed = seed
        self.synthetic = synthetic or SyntheticFaces(size=size, batch_size=batch_size)
        self.crops: dict[str, Crops] = {}

    @property
    def described(self) -> str:
        """What a model card says of these data."""
        return f"{len(self.crops['train'])} photographs and {self.synthetic.described}"

    def setup(self, stage: str) -> None:
        if self.crops:
            return
        crops = find_crops(self.folder, self.size)
        order = np.random.default_rng(self.seed).permutation(len(crops))
        kept = max(1, round(self.val_share * len(crops)))
        if len(crops) <= kept:
            raise InputError(f"{self.folder} has {len(crops)} usable photographs; two are needed.")
        self.crops = {
            "val": Crops([crops[index] for index in order[:kept]], self.seed),
            "train": Crops([crops[index] for index in order[kept:]], self.seed),
        }

    def train_dataloader(self) -> CombinedLoader:
        crops = self.crops["train"]
        steps = max(len(crops) // self.batch_size, 1)
        seen = partial(seen_samples, self.trainer, self.batch_size)
        loaders = {
            "portraits": StreamLoader(crops, self.batch_size, steps * self.batch_size, seen),
            "synthetic": self.synthetic.stream(steps, self.trainer),
        }
        return CombinedLoader(loaders, "min_size")

    def val_dataloader(self) -> CombinedLoader:
        portraits: DataLoader[Crop] = DataLoader(self.crops["val"], self.batch_size)
        loaders = {"portraits": portraits, "synthetic": self.synthetic.val_dataloader()}
        return CombinedLoader(loaders, "min_size")

    def test_dataloader(self) -> CombinedLoader:
        return self.val_dataloader()

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> dict[str, Batch]:
        photograph, mask = (part.float() / 255 for part in batch["portraits"])
        synthetic = self.synthetic.on_after_batch_transfer(batch["synthetic"], dataloader_idx)
        return {"portraits": Batch(photograph.movedim(-1, 1), mask), "synthetic": synthetic}


def find_crops(folder: Path, size: int) -> list[Crop]:
    """The faces of all pictures in a folder, in the order of their names.

    Raises `InputError` if there is no folder, or no picture with a face in it.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder; give the folder of your photographs.")
    pictures = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES)
    crops = [crop for path in pictures if (crop := _crop(path, size)) is not None]
    if not crops:
        raise InputError(
            f"{folder} holds no photograph with a face in it ({len(pictures)} pictures looked at)."
        )
    skipped = len(pictures) - len(crops)
    print(f"{folder}: {len(crops)} faces, {skipped} pictures skipped", file=sys.stderr)
    return crops


def _crop(path: Path, size: int) -> Crop | None:
    try:
        photo = read_photo(path)
    except InputError as error:
        print(error, file=sys.stderr)
        return None
    face = find_face(photo)
    if face is None:
        return None
    box = crop_box(face, photo.shape[1], photo.shape[0])
    mask = skin_mask(photo, face)[box.slices]
    scale = size / max(box.width, box.height)
    width, height = max(1, round(box.width * scale)), max(1, round(box.height * scale))
    pad = ((0, size - height), (0, size - width))
    return Crop(
        np.pad(resize(photo[box.slices], width, height), (*pad, (0, 0)), mode="edge"),
        np.pad((255 * resize(mask, width, height)).round().astype(np.uint8), pad),
    )
