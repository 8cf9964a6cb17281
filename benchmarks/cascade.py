"""The cascade of local binary patterns that found faces before BlazeFace, as the baseline.

A detection must be confirmed in the mirrored picture, which rejects most false ones; of the rest,
the largest and most central one is chosen. It finds faces that are upright and frontal.
"""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import data
from skimage.feature import Cascade

from skinnet.images import Box, resize

_SIZE = 320
"""Longer side, in pixels, of the picture in which faces are detected."""

_PASSES = ((0.12, 1.1, 4), (0.25, 1.05, 3))
"""Smallest face relative to the shorter side, ratio of successive scales, and number of detections
that must agree. The second pass runs if the first one finds no face."""

Detected = dict[str, int]


def find_face(photo: NDArray[np.uint8]) -> Box | None:
    """Find the largest and most central face of a photograph, uint8 sRGB [H, W, 3].

    Source:
        Cascade of local binary patterns (Liao et al. 2007), as scikit-image ships it.
    """
    ratio = max(max(photo.shape[:2]) / _SIZE, 0.5)
    height, width = (max(1, round(side / ratio)) for side in photo.shape[:2])
    small = resize(photo, width, height)
    for smallest, step, agreeing in _PASSES:
        detected = _detect(small, smallest * min(small.shape[:2]), step, agreeing)
        faces = [face for face in detected if _confirm_in_mirror(small, face)]
        if faces:
            best = max(faces, key=lambda face: _score(face, small.shape))
            left, top, side = (round(best[key] * ratio) for key in ("c", "r", "width"))
            return Box(left, top, left + side, top + side)
    return None


def _detect(
    small: NDArray[np.uint8], smallest: float, step: float, agreeing: int
) -> list[Detected]:
    least, most = max(24, round(smallest)), min(small.shape[:2])
    if most < least:
        return []
    detected: list[Detected] = load_cascade().detect_multi_scale(
        small, step, 1, (least, least), (most, most), min_neighbor_number=agreeing
    )
    return detected


def _confirm_in_mirror(small: NDArray[np.uint8], face: Detected) -> bool:
    top, left, side = face["r"], face["c"], face["width"]
    edge = round(0.35 * side)
    rows = slice(max(0, top - edge), top + side + edge)
    columns = slice(max(0, left - edge), left + side + edge)
    mirrored = np.ascontiguousarray(small[rows, columns][:, ::-1])
    return bool(_detect(mirrored, 0.7 * side, 1.05, 3))


def _score(face: Detected, shape: tuple[int, ...]) -> float:
    """Width of a detection, times a weight that falls to one half at the picture's corners."""
    distance = np.hypot(
        (face["r"] + face["height"] / 2) / shape[0] - 0.5,
        (face["c"] + face["width"] / 2) / shape[1] - 0.5,
    )
    return float(face["width"] * (1 - distance / np.sqrt(2)))


@cache
def load_cascade() -> Any:
    """Load the cascade once."""
    return Cascade(data.lbp_frontal_face_cascade_filename())  # type: ignore[no-untyped-call]
