"""Photographs of people of whom there are two each: their crops, regions and colours."""

import csv
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images import srgb_to_linear
from skinnet.images._walk import Found
from skinnet.images.faces._face_parts import FaceParts, find_face_parts
from skinnet.images.srgb import LUMINANCE_WEIGHTS
from train.heads import Head, Skipped, read_head

REGIONS = ("forehead", "left_cheek", "right_cheek", "nose", "chin")
"""Regions that are compared; lips and eyelids are painted, and necks hidden."""

INDEX = "index.csv"

_LEAST_SKIN = 0.01
"""Least share of the crop that is skin."""

_DARKEST = 1e-3


class PersonCrop(NamedTuple):
    """A photograph of a person.

    Attributes:
        photograph: The head, uint8 sRGB [size, size, 3].
        mask: Its estimated skin, uint8 [size, size].
        regions: Number of the region of each pixel, from 1 in the order of `REGIONS`; 0 is none.
        colour: Log R/G, log B/G and log luminance of the median skin, in linear sRGB.
    """

    photograph: NDArray[np.uint8]
    mask: NDArray[np.uint8]
    regions: NDArray[np.uint8]
    colour: NDArray[np.float32]


Couple = tuple[PersonCrop, PersonCrop]


def read_couples(folder: Path, size: int) -> dict[str, Couple]:
    """Read the photographs of people, two of each.

    Args:
        folder: Holds the photographs and `index.csv`, whose columns `person`, `first` and `second`
            name a person and the files of two photographs.
        size: Side of the crops in pixels.

    Returns:
        Crops by person. People of whom a photograph cannot be used are left out.

    Raises:
        InputError: If there is no such index, or nobody can be read.
    """
    couples = {}
    rows = read_index(folder)
    for number, row in enumerate(rows, 1):
        both = [crop_person(folder / row[name], size) for name in ("first", "second")]
        if both[0] is not None and both[1] is not None:
            couples[row["person"]] = both[0], both[1]
        print(f"\rPeople of {folder}: {number} of {len(rows)} read.", end="", file=sys.stderr)
    print(f"\n{folder}: {len(rows) - len(couples)} people left out.", file=sys.stderr)
    if not couples:
        raise InputError(f"{folder} shows no person in two usable photographs.")
    return couples


def read_index(folder: Path) -> list[dict[str, str]]:
    """Read the index of a folder of pairs.

    Raises:
        InputError: If it is missing or lacks a column.
    """
    path = folder / INDEX
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except READ_ERRORS as error:
        raise InputError(f"{path} cannot be read ({error}); {_REMEDY}.") from error
    if not rows or not {"person", "first", "second"} <= set(rows[0]):
        raise InputError(f"{path} lacks rows or one of its columns; {_REMEDY}.")
    return rows


_REMEDY = (
    "give a folder with index.csv, whose columns person, first and second name a person and the "
    "files of two photographs"
)


def crop_person(path: Path, size: int) -> PersonCrop | None:
    """Crop the head in a photograph; None if it cannot be used."""
    head = read_head(Found(str(path)))
    if isinstance(head, Skipped):
        return None
    photograph, mask = head.cut(size), head.cut_mask(size)
    skin = photograph[mask > 127]
    if len(skin) < _LEAST_SKIN * size**2:
        return None
    return PersonCrop(photograph, mask, _label_regions(head, size), measure_colour(skin))


def measure_colour(skin: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Measure log R/G, log B/G and log luminance of the median of pixels, uint8 sRGB [N, 3]."""
    median = np.median(srgb_to_linear(skin), 0).clip(_DARKEST)
    red, green, blue = np.log(median)
    return np.array([red - green, blue - green, np.log(median @ LUMINANCE_WEIGHTS)], np.float32)


def _label_regions(head: Head, size: int) -> NDArray[np.uint8]:
    parts = find_face_parts(head.photo, head.face)
    labels = np.zeros((size, size), np.uint8)
    for number, name in enumerate(REGIONS, 1):
        labels[head.cut_layer(_paint_region(parts, name, head), size) > 127] = number
    return labels


def _paint_region(parts: FaceParts, name: str, head: Head) -> NDArray[np.float32]:
    layer = np.zeros(head.photo.shape[:2], np.float32)
    patch = parts.regions[name].patch
    layer[patch.box.slices][patch.inside] = 1
    return layer
