"""The teeth in a photograph of a face."""

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._mesh_outlines import INNER_LIPS
from skinnet.images.faces._near_white import select_near_white
from skinnet.images.faces._outlines import Patch, fill_outlines, measure_area, measure_depth
from skinnet.images.faces._skin_reference import Colours

_OPPOSITE = 10
"""Place of the other corner of the mouth in the inner lips."""

_LEAST_WIDTH = 24.0
"""Least width of a mouth, in pixels."""

_LEAST_OPENING = 0.06
"""Least area of an open mouth, in squares of its width."""

_LIPS_EDGE = 0.02
"""Width of the lips' edge and its shadow, in widths of the mouth."""


def locate_teeth(
    photo: NDArray[np.uint8], landmarks: NDArray[np.float32], skin: Colours
) -> list[Patch]:
    """Locate the teeth between the lips.

    Gums, the tongue, gaps and highlights are left out.

    Args:
        photo: uint8 sRGB [H, W, 3].
        landmarks: Points of the face mesh [478, 2], in pixels of the photograph.
        skin: The colour of the face's skin.

    Returns:
        Their pixels, if the mouth is open and at least 24 pixels wide.
    """
    lips = landmarks[list(INNER_LIPS)].astype(np.float64)
    width = float(np.linalg.norm(lips[_OPPOSITE] - lips[0]))
    if width < _LEAST_WIDTH or abs(measure_area(lips)) < _LEAST_OPENING * width**2:
        return []
    mouth = fill_outlines([lips])
    inside = mouth.choose(measure_depth(mouth.centres, lips) > _LIPS_EDGE * width)
    return [select_near_white(photo, inside.clip(*photo.shape[:2]), skin)]
