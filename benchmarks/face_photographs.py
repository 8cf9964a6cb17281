"""Photographs of faces, cut out as users' are, with what is measured in their pixels."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.baselines import DARKEST
from benchmarks.portraits import LARGEST
from skinnet.images import Box, find_faces, frame_head, resize, segment_skin, srgb_to_linear
from skinnet.images.faces._face_parts import FaceParts, find_face_parts
from skinnet.images.faces._largest import choose_largest
from skinnet.images.faces._outlines import Patch

REGIONS = {
    "forehead": ("forehead",),
    "cheeks": ("left_cheek", "right_cheek"),
    "nose": ("nose",),
    "chin": ("chin",),
}
"""Regions whose readings are compared, and the parts of the face that make each."""

Photograph = NDArray[np.uint8]


class FacePhotograph(NamedTuple):
    """A photograph and the face in it.

    Attributes:
        photo: uint8 sRGB, [height, width, 3].
        skin: Where `segment_skin` finds skin in it, bool [height, width].
        box: The head, as users' photographs are framed.
        parts: The parts of the face.
    """

    photo: Photograph
    skin: NDArray[np.bool_]
    box: Box
    parts: FaceParts

    @property
    def crop(self) -> Photograph:
        """The head, at most `LARGEST` pixels wide and high."""
        return resize(np.ascontiguousarray(self.photo[self.box.slices]), *self._sides)

    def find_regions(self) -> dict[str, NDArray[np.bool_]]:
        """Find the pixels of each region in the crop."""
        return {name: self._find_region(names) for name, names in REGIONS.items()}

    def _find_region(self, names: tuple[str, ...]) -> NDArray[np.bool_]:
        whole = np.zeros(self.skin.shape, np.float32)
        for name in names:
            box, inside = self.parts.regions[name].patch
            whole[box.slices][inside] = 1
        return resize(np.ascontiguousarray(whole[self.box.slices]), *self._sides) > 0.5

    @property
    def _sides(self) -> tuple[int, int]:
        scale = min(1.0, LARGEST / max(self.box.width, self.box.height))
        return round(self.box.width * scale), round(self.box.height * scale)


def find_face(photo: Photograph) -> FacePhotograph | None:
    """Find the largest face of a photograph; None without one."""
    if (face := choose_largest(find_faces(photo))) is None:
        return None
    mask = segment_skin(photo, face)
    box = frame_head(face.box, photo.shape[1], photo.shape[0])
    skin = np.zeros(mask.shape, bool)
    # Without any skin, the colour of the whole head, as `benchmarks.portraits` has it.
    skin[box.slices] = mask[box.slices] >= min(0.5, mask[box.slices].max())
    return FacePhotograph(photo, skin, box, find_face_parts(photo, face))


def measure_colour(photo: Photograph, where: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Measure the median linear RGB of some pixels [3]; NaN without any."""
    if not where.any():
        return np.full(3, np.nan)
    return np.median(srgb_to_linear(photo[where]), 0).astype(np.float64)


def measure_patch(photo: Photograph, patches: tuple[Patch, ...]) -> NDArray[np.float64]:
    """Measure the median linear RGB of some patches of a photograph; NaN without pixels."""
    pixels = [photo[box.slices][inside] for box, inside in patches]
    joined = np.concatenate([np.zeros((0, 3), np.uint8), *pixels])
    return measure_colour(joined, np.ones(len(joined), bool))


def measure_regions(photo: Photograph, parts: FaceParts) -> Mapping[str, NDArray[np.float64]]:
    """Measure the median linear RGB of each region of a face."""
    return {name: measure_patch(photo, (one.patch,)) for name, one in parts.regions.items()}


def describe_colour(linear: NDArray[np.floating]) -> NDArray[np.float64]:
    """Describe linear RGB [..., 3] by log R/G, log B/G and log G."""
    red, green, blue = np.moveaxis(np.log(np.maximum(linear, DARKEST)), -1, 0)
    return np.stack([red - green, blue - green, green], -1)
