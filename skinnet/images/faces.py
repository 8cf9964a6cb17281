"""Faces in a photograph: find one, crop around it, and mark its skin."""

from functools import cache
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from skimage import data
from skimage.feature import Cascade

from skinnet.images.skin_segmentation import skin_likeness

SEARCH_SIZE = 320
"""Longer side, in pixels, of the picture in which faces are sought."""

HEAD_CENTRE = 0.45
"""Middle between the hair's top and the chin, in heights of the face's box from its top."""

_PASSES = ((0.12, 1.1, 4), (0.25, 1.05, 3))
"""Smallest face relative to the shorter side, step between scales, and detections that must agree;
the second, for large faces only, runs if the first finds none."""

Pixels = TypeVar("Pixels", NDArray[np.uint8], NDArray[np.float32])


class Box(NamedTuple):
    """A rectangle of pixels; `right` and `bottom` are the first ones outside."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Pixels from left to right."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Pixels from top to bottom."""
        return self.bottom - self.top

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns of an array [H, W, ...]."""
        return slice(self.top, self.bottom), slice(self.left, self.right)


def find_face(photo: NDArray[np.uint8]) -> Box | None:
    """The largest, most central upright frontal face of uint8 sRGB [H, W, 3], brow to chin.

    The box is square and may reach over the picture's edge by a rounding. None if there is no face
    of at least an eighth of the shorter side. A face is found again in the mirror; most of what
    only looks like one to the detector is not.
    """
    small, ratio = _shrink(photo, SEARCH_SIZE)
    for smallest, step, agreeing in _PASSES:
        found = _detect(small, smallest * min(small.shape[:2]), step, agreeing)
        faces = [face for face in found if _in_mirror(small, face)]
        if faces:
            return _to_box(max(faces, key=lambda face: _merit(face, small.shape)), ratio)
    return None


def crop_box(face: Box, width: int, height: int, margin: float = 2.0) -> Box:
    """The square of `margin` times the face's side around the head, clipped to the picture.

    From a margin of 1.4 on, hair and chin of an upright head are inside.
    """
    half = margin * max(face.width, face.height) / 2
    x = (face.left + face.right) / 2
    y = face.top + HEAD_CENTRE * face.height
    return Box(
        max(0, round(x - half)),
        max(0, round(y - half)),
        min(width, round(x + half)),
        min(height, round(y + half)),
    )


def skin_mask(photo: NDArray[np.uint8], face: Box) -> NDArray[np.float32]:
    """How surely each pixel is skin of this face, float32 [H, W] in [0, 1].

    Pseudo ground truth for training on photographs: a colour model of the cheeks and the nose,
    within an ellipse around the face and a strip for the neck. Eyes, brows, hair, beard and lips
    drop out where their colour differs.
    """
    height, width = photo.shape[:2]
    around = crop_box(face, width, height, margin=2.4)
    mask = np.zeros((height, width), np.float32)
    if min(around.width, around.height) < 1:
        return mask
    crop = photo[around.slices]
    small, ratio = _shrink(crop, round(96 * max(crop.shape[:2]) / face.width), enlarge=True)
    inside = [(value - start) / ratio for value, start in zip(face, around[:2] * 2, strict=True)]
    likeness = skin_likeness(small, (inside[0], inside[1], inside[2], inside[3]))
    mask[around.slices] = resize(likeness, crop.shape[1], crop.shape[0]).clip(0, 1)
    return mask


def resize(channel: Pixels, width: int, height: int) -> Pixels:
    """Bilinear resizing of uint8 [H, W, 3] or float32 [H, W], averaging where it shrinks."""
    image = Image.fromarray(np.ascontiguousarray(channel))
    return np.array(image.resize((width, height), Image.Resampling.BILINEAR, reducing_gap=3.0))


def _shrink(
    photo: NDArray[np.uint8], longer: int, enlarge: bool = False
) -> tuple[NDArray[np.uint8], float]:
    """The photograph with that longer side, and original pixels per pixel of it."""
    height, width = photo.shape[:2]
    ratio = max(height, width) / longer
    if ratio < 1 and not enlarge:
        ratio = max(ratio, 0.5)
    return resize(photo, max(1, round(width / ratio)), max(1, round(height / ratio))), ratio


def _detect(
    small: NDArray[np.uint8], smallest: float, step: float, agreeing: int
) -> list[dict[str, int]]:
    """Squares (r, c, width, height) that look like faces, of `smallest` pixels a side or more."""
    least, most = max(24, round(smallest)), min(small.shape[:2])
    if most < least:
        return []
    found: list[dict[str, int]] = _cascade().detect_multi_scale(
        small, step, 1, (least, least), (most, most), min_neighbor_number=agreeing
    )
    return found


def _in_mirror(small: NDArray[np.uint8], face: dict[str, int]) -> bool:
    top, left, side = face["r"], face["c"], face["width"]
    edge = round(0.35 * side)
    rows = slice(max(0, top - edge), top + side + edge)
    columns = slice(max(0, left - edge), left + side + edge)
    mirrored = np.ascontiguousarray(small[rows, columns][:, ::-1])
    return bool(_detect(mirrored, 0.7 * side, 1.05, 3))


def _merit(face: dict[str, int], shape: tuple[int, ...]) -> float:
    """Size of a detection, halved at the picture's corner."""
    away = np.hypot(
        (face["r"] + face["height"] / 2) / shape[0] - 0.5,
        (face["c"] + face["width"] / 2) / shape[1] - 0.5,
    )
    return float(face["width"] * (1 - away / np.sqrt(2)))


def _to_box(face: dict[str, int], ratio: float) -> Box:
    left, top, side = (round(face[key] * ratio) for key in ("c", "r", "width"))
    return Box(left, top, left + side, top + side)


@cache
def _cascade() -> Any:
    return Cascade(data.lbp_frontal_face_cascade_filename())  # type: ignore[no-untyped-call]
