"""The largest of some faces."""

from collections.abc import Iterable

from skinnet.images.faces.face import Face


def choose_largest(faces: Iterable[Face]) -> Face | None:
    """The largest of some faces; None if there is none."""
    return max(faces, key=lambda face: face.box.width, default=None)
