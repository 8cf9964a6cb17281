"""Heads in photographs: found, framed, and cut out as training sees them."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images import find_faces, frame_head, read_photo, resize, segment_skin
from skinnet.images._colour_content import find_tone
from skinnet.images._walk import Found
from skinnet.images.box import Box
from skinnet.images.faces._largest import choose_largest
from skinnet.images.faces.face import Face


class Skipped(NamedTuple):
    """A file that training does not use, and the reason in words."""

    path: Path
    reason: str
    readable: bool
    colourless: bool = False


class Head(NamedTuple):
    """A photograph, uint8 sRGB [H, W, 3], the largest face in it, and the box of its head."""

    photo: NDArray[np.uint8]
    face: Face
    box: Box

    def cut(self, size: int) -> NDArray[np.uint8]:
        """Cut the head out, with its longer side at `size` pixels and padded to a square."""
        width, height = self._measure(size)
        pad = ((0, size - height), (0, size - width), (0, 0))
        return np.pad(resize(self.photo[self.box.slices], width, height), pad, mode="edge")

    def cut_mask(self, size: int) -> NDArray[np.uint8]:
        """The estimated skin of `cut`, which is 0 where it is padded."""
        return self.cut_layer(segment_skin(self.photo, self.face), size)

    def cut_layer(self, layer: NDArray[np.float32], size: int) -> NDArray[np.uint8]:
        """Cut a layer [H, W] in [0, 1] of the photograph as `cut` does."""
        width, height = self._measure(size)
        small = (255 * resize(layer[self.box.slices], width, height)).round().astype(np.uint8)
        return np.pad(small, ((0, size - height), (0, size - width)))

    def _measure(self, size: int) -> tuple[int, int]:
        scale = size / max(self.box.width, self.box.height)
        return max(1, round(self.box.width * scale)), max(1, round(self.box.height * scale))


def read_head(found: Found) -> Head | Skipped:
    """Read a picture and find the largest face in it.

    Args:
        found: The picture's path.

    Returns:
        The head, or why there is none.
    """
    path = Path(found.path)
    if found.error is not None:
        return Skipped(path, str(found.error), readable=False)
    try:
        photo = read_photo(path)
    except InputError as error:
        return Skipped(path, str(error), readable=False)
    face = choose_largest(find_faces(photo))
    if face is None:
        return Skipped(path, "No face was found in it.", readable=True)
    box = frame_head(face.box, photo.shape[1], photo.shape[0])
    tone = find_tone(photo, box, face.box)
    if tone is not None:
        return Skipped(path, f"It has no colour: {tone}.", readable=True, colourless=True)
    return Head(photo, face, box)
