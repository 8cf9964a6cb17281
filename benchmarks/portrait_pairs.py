"""People in two photographs by different photographers."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from benchmarks.face_photographs import FacePhotograph, find_face
from skinnet.images import read_photo
from train.pair_split import choose_kept
from train.people import read_index

FOLDER = Path(__file__).parents[2] / "shared" / "data" / "faces"


class Person(NamedTuple):
    """A person in two photographs; `kept` is whether training never sees them."""

    name: str
    kept: bool
    faces: tuple[FacePhotograph, FacePhotograph]


def read_people(folder: Path, every: int = 1) -> Iterator[Person]:
    """Read every nth person of a folder with an index; those without a face are left out."""
    rows = read_index(folder)
    kept = choose_kept([row["person"] for row in rows])
    for number, row in enumerate(rows[::every], 1):
        print(f"\rPairs: {number:,}. ", end="", file=sys.stderr)
        first, second = (find_face(read_photo(folder / row[one])) for one in ("first", "second"))
        if first is not None and second is not None:
            yield Person(row["person"], row["person"] in kept, (first, second))
    print(file=sys.stderr)
