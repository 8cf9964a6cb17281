"""Portraits and where their faces are, by sources other than the finder.

Boxes of the Congress portraits come from their index, made by a cascade of local binary patterns;
four of them were wrong, and are marked by hand. In the London set the box follows from the marked
eyes and chin.
"""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images import Box, read_photo
from skinnet.images.faces._face_place import to_box
from skinnet.images.faces._turned_square import TurnedSquare

BY_HAND = {
    "C001059": Box(32, 78, 177, 223),
    "D000355": Box(22, 62, 187, 227),
    "L000557": Box(47, 78, 189, 220),
    "T000057": Box(46, 77, 178, 209),
}
"""Boxes of faces for which the index has an eye, a mouth, hair or a neck."""

RIGHT_EYE, LEFT_EYE, CHIN = 0, 1, 129
"""Points of London's templates: the pupils, and the lowest point of the chin."""

SIDE, LOWER = 1.485, 0.162
"""Side of the box, and its centre below the eyes, in distances from the eyes to the chin: medians
of the cascade's boxes on the London set."""


class KnownFace(NamedTuple):
    """A portrait, and the box of its face, from the brows to the chin.

    Attributes:
        path: Its file.
        box: A square around the face.
    """

    path: Path
    box: Box

    def read(self) -> NDArray[np.uint8]:
        """Read the portrait, uint8 sRGB [H, W, 3]."""
        return read_photo(self.path)


def list_portraits(folder: Path, every: int = 1) -> list[KnownFace]:
    """List every nth portrait of Congress, then of London."""
    if not (folder / "congress" / "index.csv").is_file():
        raise InputError(f"{folder} has no congress/index.csv; give the portraits with --faces.")
    return [*_list_congress(folder / "congress")][::every] + [*_list_london(folder / "london")][
        ::every
    ]


def read_template(path: Path) -> NDArray[np.float64]:
    """Read the columns and rows [189, 2] of a template of the London set."""
    count = int(path.read_text(encoding="utf-8").split(maxsplit=1)[0])
    return np.loadtxt(path, skiprows=1, max_rows=count)


def _list_congress(folder: Path) -> Iterator[KnownFace]:
    with (folder / "index.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            path = folder / row["file"]
            left, top, side = (int(row[name]) for name in ("face_x", "face_y", "face_w"))
            box = BY_HAND.get(path.stem, Box(left, top, left + side, top + side))
            yield KnownFace(path, box)


def _list_london(folder: Path) -> Iterator[KnownFace]:
    for path in sorted(folder.glob("*.jpg")):
        points = read_template(path.with_suffix(".tem"))
        eyes = (points[RIGHT_EYE] + points[LEFT_EYE]) / 2
        height = float(np.linalg.norm(points[CHIN] - eyes))
        centre = eyes + LOWER * (points[CHIN] - eyes)
        yield KnownFace(path, to_box(TurnedSquare(*centre, SIDE * height)))
