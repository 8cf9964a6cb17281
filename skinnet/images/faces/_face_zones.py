"""Where the parts of a face are in a picture, by the landmarks of MediaPipe's mesh."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.faces._mesh_outlines import (
    BROW,
    CHIN,
    INNER_LIPS,
    LEFT_EYE,
    LIPS,
    RIGHT_EYE,
)
from skinnet.images.faces._outlines import mark_outlines

_OVAL = (
    *(10, 338, 297, 332, 284, 251, 389, 356, 454, 323, 361, 288, 397, 365, 379, 378, 400, 377),
    *(152, 148, 176, 149, 150, 136, 172, 58, 132, 93, 234, 127, 162, 21, 54, 103, 67, 109),
)
_BROWS = (
    (70, 63, 105, 66, 107, 55, 65, 52, 53, 46),
    (300, 293, 334, 296, 336, 285, 295, 282, 283, 276),
)
_NOSTRILS = (98, 240, 64, 48, 115, 220, 45, 4, 275, 440, 344, 278, 294, 460, 327, 326, 2, 97)
_JAW = (132, 58, 172, 136, 150, 149, 176, 148, 152, 377, 400, 378, 379, 365, 397, 288, 361)
_BEARD = (234, *_JAW, 454, 425, 327, 2, 98, 205)

_CHIN_PAD = (200, 201, 208, 171, 152, 396, 428, 421)
_CLOTH = (6, 117, 123, *_JAW, 352, 346)
"""Outline of a face mask, from the bridge of the nose to the jaw."""

_NECK = 0.45
"""Length of the neck below the jaw, in distances from the brows to the chin."""


class FaceZones(NamedTuple):
    """Where the parts of a face are, bool [h, w] each.

    Attributes:
        face: The whole face, from the middle of the forehead to the chin.
        eyes: What is between the lids.
        brows: The eyebrows.
        lips: Both lips, and what is between them.
        mouth: What is between the lips.
        nostrils: The lower half of the nose.
        neck: Below the jaw.
        beard: Where beards grow: cheeks, chin, and around the mouth.
        chin: The middle of the chin.
        cloth: What a face mask covers that is worn on the nose.
        right: The half of the picture on the person's right.
        down: Columns and rows from the brows to the chin, float [2].
    """

    face: NDArray[np.bool_]
    eyes: NDArray[np.bool_]
    brows: NDArray[np.bool_]
    lips: NDArray[np.bool_]
    mouth: NDArray[np.bool_]
    nostrils: NDArray[np.bool_]
    neck: NDArray[np.bool_]
    beard: NDArray[np.bool_]
    chin: NDArray[np.bool_]
    cloth: NDArray[np.bool_]
    right: NDArray[np.bool_]
    down: NDArray[np.float32]


def mark_zones(landmarks: NDArray[np.float32], shape: tuple[int, ...]) -> FaceZones:
    """Mark the parts of a face in a picture of a shape [h, w, ...].

    Args:
        landmarks: Columns and rows [478, 2] in pixels of that picture.
        shape: Its rows and columns.
    """

    def mark(*outlines: tuple[int, ...]) -> NDArray[np.bool_]:
        return mark_outlines([landmarks[list(outline)] for outline in outlines], shape)

    down = landmarks[CHIN] - landmarks[BROW]
    jaw = landmarks[list(_JAW)]
    neck = mark_outlines([np.concatenate([jaw, jaw[::-1] + _NECK * down])], shape)
    face = mark(_OVAL)
    x, y = landmarks[CHIN]
    rows, columns = np.ogrid[: shape[0], : shape[1]]
    right = (columns + 0.5 - x) * down[1] - (rows + 0.5 - y) * down[0] < 0
    return FaceZones(
        face,
        mark(RIGHT_EYE, LEFT_EYE),
        mark(*_BROWS),
        mark(LIPS),
        mark(INNER_LIPS),
        mark(_NOSTRILS),
        neck & ~face,
        mark(_BEARD),
        mark(_CHIN_PAD),
        mark(_CLOTH),
        right,
        down,
    )


def grow(zone: NDArray[np.bool_], distance: float) -> NDArray[np.bool_]:
    """Grow a zone by a distance in pixels, along rows and columns; a negative one shrinks it."""
    size = 2 * max(1, round(abs(distance))) + 1
    extreme = ndimage.maximum_filter if distance > 0 else ndimage.minimum_filter
    grown: NDArray[np.bool_] = extreme(zone.view(np.uint8), size).view(np.bool_)
    return grown
