"""Named regions of a face, as pixels between points of its mesh."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._mesh_outlines import CHIN, INNER_LIPS, LIPS
from skinnet.images.faces._outlines import (
    Outline,
    Patch,
    fill_outlines,
    frame_outlines,
    measure_area,
)

_LEAST_AREA = 0.3
"""Least area of a cheek or an eyelid, in areas of the one on the other side. The mesh only guesses
where a smaller one is, because it is turned away."""

_NECK_START, _NECK_END = 0.06, 0.3
"""Distances of the neck's ends from the jaw line, in lengths from the forehead to the chin."""

_JAW = (150, 149, 176, 148, 152, 377, 400, 378, 379)
_TOP = 10


class _Part(NamedTuple):
    """A part of a region: indices of its outline, and of a hole in it."""

    outline: tuple[int, ...]
    hole: tuple[int, ...] = ()


class _Sides(NamedTuple):
    """The same part on the person's right and left side, with corners in the same order.

    In the picture the right one runs clockwise, and so the left one anticlockwise.
    """

    right: _Part
    left: _Part


_WHOLE = {
    # From the brows to the last points of the mesh, which are below the hairline.
    "forehead": _Part((10, 109, 67, 103, 104, 105, 66, 107, 9, 336, 296, 334, 333, 332, 297, 338)),
    # From the bridge to the tip, without nostrils.
    "nose": _Part((6, 122, 174, 198, 49, 220, 45, 4, 275, 440, 279, 420, 399, 351)),
    "lips": _Part(LIPS, INNER_LIPS),
    "chin": _Part((182, 83, 18, 313, 406, 418, 262, 369, 396, 175, 171, 140, 32, 194)),
}

# Over the cheekbone, away from the nasolabial fold and from where beards grow.
_CHEEKS = _Sides(
    _Part((117, 118, 101, 36, 205, 187, 123)), _Part((346, 347, 330, 266, 425, 411, 352))
)

# From the crease to the brow above, and to the edge of the orbit below, without lashes.
_EYELIDS = _Sides(
    _Part(
        (226, 113, 225, 224, 223, 222, 221, 189, 244, 233, 232, 231, 230, 229, 228, 31),
        (130, 25, 110, 24, 23, 22, 26, 112, 243, 190, 56, 28, 27, 29, 30, 247),
    ),
    _Part(
        (446, 342, 445, 444, 443, 442, 441, 413, 464, 453, 452, 451, 450, 449, 448, 261),
        (359, 255, 339, 254, 253, 252, 256, 341, 463, 414, 286, 258, 257, 259, 260, 467),
    ),
)

REGION_NAMES = (
    "forehead",
    "left_cheek",
    "right_cheek",
    "nose",
    "lips",
    "chin",
    "neck",
    "eyelids",
)
"""Regions of a face; left and right are the person's."""


def locate_region(landmarks: NDArray[np.float32], name: str) -> Patch:
    """Locate a region of a face.

    Args:
        landmarks: Points of the face mesh [478, 2], in pixels of the photograph.
        name: One of `REGION_NAMES`.

    Returns:
        Its pixels, those outside the photograph and those that hair, cloth or a hand hides
        included; none if the region is turned away.
    """
    if name == "neck":
        return fill_outlines([_outline_neck(landmarks)])
    parts = _list_visible_parts(landmarks, name)
    if not parts:
        box = frame_outlines([landmarks])
        return Patch(box, np.zeros((box.height, box.width), bool))
    outlines = [landmarks[list(part.outline)] for part in parts]
    return fill_outlines(outlines, [landmarks[list(part.hole)] for part in parts if part.hole])


def _list_visible_parts(landmarks: NDArray[np.float32], name: str) -> list[_Part]:
    if name in _WHOLE:
        return [_WHOLE[name]]
    sides = _EYELIDS if name == "eyelids" else _CHEEKS
    right, left = (measure_area(landmarks[list(part.outline)]) for part in sides)
    least = _LEAST_AREA * max(right, -left)
    parts = []
    if right > least and name != "left_cheek":
        parts.append(sides.right)
    if -left > least and name != "right_cheek":
        parts.append(sides.left)
    return parts


def _outline_neck(landmarks: NDArray[np.float32]) -> Outline:
    """Below the jaw line, in the direction of the face's axis."""
    jaw = landmarks[list(_JAW)].astype(np.float64)
    down = landmarks[CHIN].astype(np.float64) - landmarks[_TOP]
    return np.concatenate([jaw + _NECK_START * down, (jaw + _NECK_END * down)[::-1]])
