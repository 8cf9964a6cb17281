"""Which of the faces of a photograph are read."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from skinnet.errors import InputError
from skinnet.images.faces.face import Face

FaceChoice = Literal["all", "largest"] | int
"""All faces, the largest one, or a number of the largest."""


def check_choice(faces: object) -> None:
    """Raise `InputError` if `faces` is neither a word that is known nor a number of faces."""
    is_known = isinstance(faces, str) and faces in ("all", "largest")
    is_count = isinstance(faces, int | np.integer) and not isinstance(faces, bool) and faces >= 1
    if not is_known and not is_count:
        raise InputError(
            f"faces is all, largest, or how many of the largest, from 1; got {faces!r:.60}."
        )


def choose_faces(found: Sequence[Face], faces: FaceChoice) -> list[int]:
    """Indices of the faces that are read, in their order; of faces of one size, the first."""
    if faces == "all":
        return list(range(len(found)))
    count = 1 if faces == "largest" else int(faces)
    by_size = sorted(range(len(found)), key=lambda index: -found[index].box.width)
    return sorted(by_size[:count])


def note_others(found: int, read: int, name: str) -> tuple[str, ...]:
    """Note that a photograph shows several faces, and how many of them are not read."""
    more = found - read
    if more < 1:
        return (f"{name} shows {found} faces, numbered from left to right.",) * (found > 1)
    faces, them = ("face was", "it") if more == 1 else ("faces were", "them")
    return (
        f"{more} more {faces} found in {name}; --faces all "
        f'(in Python faces="all") reads {them} too.',
    )
