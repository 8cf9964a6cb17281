"""A folder of photographs as training data, without any truth."""

import csv
import io
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jsonargparse.typing import NonNegativeInt, PositiveInt, restricted_number_type
from lightning.pytorch.utilities import rank_zero_only
from numpy.typing import NDArray
from torch.utils.data import DataLoader, Dataset

from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.images import (
    linear_to_srgb,
    srgb_to_linear,
    to_uint8,
)
from skinnet.images._walk import Found, Walk, walk
from train.batch import Batch
from train.beside_synthetic import BesideSynthetic
from train.guards import list_names
from train.heads import Skipped, read_head
from train.synthetic.faces import SyntheticFaces

Share = restricted_number_type("Share", float, [(">=", 0), ("<", 1)])

EXPOSURE_SD, WHITE_BALANCE_SD = 0.4, 0.03
"""Standard deviations of the augmentation, in logarithms: of all channels, and of R/G and B/G."""


class Crop(NamedTuple):
    """A face cut out of a photograph: uint8 sRGB [size, size, 3] and its skin mask, uint8."""

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]


class Pair(NamedTuple):
    """A crop in two versions of different exposure and white balance."""

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    again: NDArray[np.uint8]


class Crops(Dataset[Pair]):
    """An endless stream of pairs.

    Every epoch has all crops. Order, mirroring and augmentation depend on the seed and the number
    of the epoch.
    """

    def __init__(self, crops: list[Crop], seed: int) -> None:
        self.crops = crops
        self.seed = seed

    def __len__(self) -> int:
        return len(self.crops)

    def __getitem__(self, index: int) -> Pair:
        epoch, place = divmod(index, len(self.crops))
        rng = np.random.default_rng([self.seed, epoch])
        order = rng.permutation(len(self.crops))
        mirrored = rng.random(len(self.crops)) < 0.5
        crop = self.crops[order[place]]
        crop = Crop(*(part[:, ::-1].copy() for part in crop)) if mirrored[place] else crop
        rng = np.random.default_rng([self.seed, epoch, place])
        return Pair(*augment(crop, rng), augment(crop, rng).photograph)


def augment(crop: Crop, rng: np.random.Generator) -> Crop:
    """Change exposure and white balance; values above white are clipped, as in a camera."""
    red, blue = rng.normal(0, WHITE_BALANCE_SD, 2)
    gain = np.exp(rng.normal(0, EXPOSURE_SD) + np.array([red, 0, blue]))
    levels = srgb_to_linear(np.arange(256, dtype=np.uint8))
    table = to_uint8(linear_to_srgb(levels[:, None] * gain))
    return crop._replace(photograph=table[crop.photograph, np.arange(3)])


class Portraits(BesideSynthetic):
    """Photographs of faces, cropped and masked by `skinnet.images`.

    What is a picture is decided by the content of a file. Unreadable pictures, pictures without a
    face, results of skinnet and files of other kinds are skipped, counted, and listed in
    `skipped.csv` of the run. Every step also sees a batch of `synthetic` faces, so that the maps
    stay tied to known pigments. In training each photograph is shown twice in different exposure
    and white balance, so that a loss can compare what is read of both.

    Args:
        folder: Folder of the photographs, searched with its subfolders.
        size: Side of the square crops in pixels.
        batch_size: Photographs in a batch of each process.
        val_share: Share of the photographs that is kept for validation.
        unreadable_share: Share of the pictures that may be unreadable; with more, training does not
            start.
        seed: Seed of the order, the augmentation and the choice of validation photographs.
        synthetic: Synthetic faces of the same size, to train on beside the photographs.
    """

    def __init__(
        self,
        folder: str,
        size: PositiveInt = 128,
        batch_size: PositiveInt = 16,
        val_share: Share = 0.1,  # type: ignore[valid-type]
        unreadable_share: Share = 0.1,  # type: ignore[valid-type]
        seed: NonNegativeInt = 0,
        synthetic: SyntheticFaces | None = None,
    ) -> None:
        super().__init__()
        self.folder = Path(folder)
        self.size = size
        self.batch_size = batch_size
        self.val_share = val_share
        self.unreadable_share = unreadable_share
        self.seed = seed
        self.synthetic = synthetic or SyntheticFaces(size=size, batch_size=batch_size)
        self.crops: dict[str, list[Crop]] = {}
        self.skipped: list[Skipped] = []

    @property
    def description(self) -> str:
        """Return one line on these data for the files of a model."""
        return f"{len(self.crops['train'])} photographs and {self.synthetic.description}"

    def has_read(self) -> bool:
        """Whether the faces were found."""
        return bool(self.crops)

    def read(self) -> None:
        """Find the faces."""
        crops, self.skipped = find_crops(self.folder, self.size, self.unreadable_share)
        order = np.random.default_rng(self.seed).permutation(len(crops))
        kept = max(1, round(self.val_share * len(crops)))
        if len(crops) <= kept:
            raise InputError(f"{self.folder} has {len(crops)} usable photographs; two are needed.")
        self.crops = {
            "val": [crops[index] for index in order[:kept]],
            "train": [crops[index] for index in order[kept:]],
        }

    def stream(self) -> Crops:
        """Stream the photographs of training."""
        return Crops(self.crops["train"], self.seed)

    def keep(self) -> DataLoader[Crop]:
        """Load the photographs kept for validation, as they are."""
        return DataLoader(self.crops["val"], self.batch_size)  # type: ignore[arg-type]

    def make_batch(self, photographs: Any) -> Batch:
        """Turn crops into a batch."""
        photograph, mask, *again = (part.float() / 255 for part in photographs)
        masks = torch.cat([mask] * (1 + len(again)))
        return Batch(torch.cat([photograph, *again]).movedim(-1, 1), masks, paired=bool(again))


def find_crops(
    folder: Path, size: int, unreadable_share: float = 0.1
) -> tuple[list[Crop], list[Skipped]]:
    """Find the faces in the pictures of a folder, in the order of their names.

    Files that are no photographs are skipped too, and stand at the end of those skipped.

    Args:
        folder: Searched with its subfolders.
        size: Side of the crops in pixels.
        unreadable_share: Share of the pictures that may be unreadable.

    Returns:
        The crops, and the files that were skipped.

    Raises:
        InputError: If there is no folder or no picture in it, if more than `unreadable_share` of
            the pictures cannot be read, or if none shows a face.
    """
    walked = find_pictures(folder)
    pictures = walked.pictures
    found = [_crop_face(picture, size) for picture in pictures]
    crops = [each for each in found if isinstance(each, Crop)]
    skipped = [each for each in found if isinstance(each, Skipped)]
    unreadable = [str(each.path) for each in skipped if not each.readable]
    if len(unreadable) > unreadable_share * len(pictures):
        raise InputError(_describe_unreadable(folder, unreadable, len(pictures), unreadable_share))
    if not crops:
        raise InputError(
            f"{folder} holds no photograph with a face in it ({len(pictures)} pictures searched)."
        )
    colourless = sum(each.colourless for each in skipped)
    _report(folder, len(crops), unreadable, len(skipped) - len(unreadable), colourless, walked)
    return crops, skipped + [
        Skipped(Path(path), f"It is {kind.one}; {kind.remedy}.", readable=True)
        for path, kind in walked.passed_over
    ]


def find_pictures(folder: Path) -> Walk:
    """Find the pictures in a folder and its subfolders, by the walk of `skinnet predict`.

    Raises:
        InputError: If there is no folder or no picture in it.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder; give the folder of your photographs.")
    found = walk([str(folder)], recursive=True)
    for path, error, _ in found.pictures:
        if error is not None and path == str(folder):
            passed_over = found.describe_passed_over()
            raise InputError(f"{error} Passed over: {passed_over}." if passed_over else str(error))
    return found


def write_skipped(skipped: list[Skipped], path: Path) -> None:
    """Write a table of the files that were skipped; without any, only its header."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("picture", "reason"))
    rows.writerows((each.path, each.reason) for each in skipped)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, _escape(text.getvalue()))


def _escape(text: str) -> str:
    """Replace what is not Unicode, in names of files, by escapes."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _describe_unreadable(folder: Path, unreadable: list[str], pictures: int, allowed: float) -> str:
    return (
        f"{len(unreadable)} of {pictures} pictures in {folder} cannot be read "
        f"({len(unreadable) / pictures:.0%}; at most {allowed:.0%} may be unreadable): "
        f"{list_names(unreadable, 5)}. "
        "Repair or remove them, or allow more with --data.init_args.unreadable_share."
    )


@rank_zero_only
def _report(
    folder: Path, faces: int, unreadable: list[str], unusable: int, colourless: int, walked: Walk
) -> None:
    summary = f"{folder}: {faces} faces, {len(unreadable) + unusable} pictures skipped"
    counts = {"without a face": unusable - colourless, "without colour": colourless}
    parts = [f"{count} {fault}" for fault, count in counts.items() if count]
    if unreadable:
        parts.append(f"{len(unreadable)} unreadable: {list_names(unreadable, 10)}")
    lines = [f"{summary} ({'; '.join(parts)})" if parts else summary]
    if walked.passed_over:
        count = len(walked.passed_over)
        lines.append(f"{folder}: {count} passed over: {walked.describe_passed_over()}")
    print(_escape("\n".join(lines)), file=sys.stderr)


def _crop_face(found: Found, size: int) -> Crop | Skipped:
    head = read_head(found)
    return head if isinstance(head, Skipped) else Crop(head.cut(size), head.cut_mask(size))
