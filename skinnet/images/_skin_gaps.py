"""Gaps in a mask of skin that are skin: highlights, moles, and the shadow below the chin."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images._connected_parts import keep_small, label_parts
from skinnet.images.faces._face_zones import FaceZones, grow

_LARGEST_HOLE = 0.15
"""Root of the area of the largest hole that is filled; this and all lengths below are in sides of
the face's box."""

_SHADOW, _HIGHLIGHT = 0.35, 0.4
"""Longest gaps that are closed: down from the chin, and across the top of a head."""

_LOWER_FACE = 0.1
"""Distance from the face's outline within which the shadow below the chin may begin."""

_MOST_OFF = 0.8
"""Difference in log R/G and log B/G to the person's skin above which no shadow is skin. Cameras
turn the darkest colours half-way to grey."""

_LEAST_BEARD = 0.01
"""Area of a hole inside the face, in areas of its box, from which on it is a beard."""

_ABOVE = (0.2, 0.35, 0.5)
"""Distances above the face, in its own heights, where the top of a head may be."""

_Mask = NDArray[np.bool_]


def fill_gaps(
    skin: _Mask, zones: FaceZones, difference: NDArray[Any], beard: _Mask, side: float
) -> _Mask:
    """Find the gaps of a mask that are skin.

    Args:
        skin: What was found to be skin, [h, w].
        zones: The parts of the face.
        difference: Log R/G, log B/G and log luminance less those of the person's skin, [h, w, 3].
        beard: Where skin is hidden by a beard or by cloth.
        side: Side of the face's box in pixels.
    """
    hidden = zones.eyes | zones.mouth
    filled = _find_holes(skin, zones, difference[..., 2], side)
    filled |= _find_shadow(skin | filled, zones, difference, side)
    filled |= _find_highlight(skin | filled, zones, difference[..., 2], side)
    closed = grow(grow(skin | filled, 0.03 * side), -0.03 * side)
    filled |= closed & ~skin & (zones.neck | zones.beard) & ~zones.nostrils
    return filled & ~grow(hidden, 1.0) & ~beard


def _find_holes(skin: _Mask, zones: FaceZones, brightness: NDArray[Any], side: float) -> _Mask:
    """Small holes in skin; dark ones near the eyes are frames of glasses, lashes and brows."""
    hidden = zones.eyes | zones.mouth
    parts = zones.brows | zones.nostrils | zones.lips
    holes = ndimage.binary_fill_holes(skin | hidden | zones.brows | zones.lips) & ~skin
    holes &= ~grow(hidden, 0.02 * side) & ~parts
    small = keep_small(holes, (_LARGEST_HOLE * side) ** 2)
    return small & ((brightness > -0.5) | ~grow(zones.eyes, 0.2 * side))


def _find_shadow(skin: _Mask, zones: FaceZones, difference: NDArray[Any], side: float) -> _Mask:
    """The shadow below the chin, between the face and the neck."""
    jaw = zones.neck | (grow(zones.face, 0.03 * side) & ~grow(zones.face, -_LOWER_FACE * side))
    gap = _find_short_gaps(skin, zones.down, _SHADOW * side) & grow(jaw, 0.04 * side)
    gap &= (difference[..., 2] < 0) & (
        np.hypot(*np.moveaxis(difference[..., :2], -1, 0)) < _MOST_OFF
    )
    # What reaches far up into the face is a beard.
    holes = (zones.face | gap) & ~skin & ~grow(zones.lips, 0.02 * side) & ~zones.brows & ~zones.eyes
    labels, sizes = label_parts(holes)
    deep = np.bincount(labels[grow(zones.face, -0.07 * side)], minlength=len(sizes))
    is_shadow = (deep < 0.15 * sizes) & (deep < _LEAST_BEARD * side**2)
    is_shadow[0] = False
    shadow: _Mask = gap & is_shadow[labels]
    return shadow


def _find_highlight(skin: _Mask, zones: FaceZones, brightness: NDArray[Any], side: float) -> _Mask:
    """The highlight at the top of a forehead or a bald head, which no skin may be above."""
    above = np.any([_shift(zones.face, -share * zones.down) for share in _ABOVE], 0)
    across = np.array([-zones.down[1], zones.down[0]])
    gap = _find_short_gaps(skin, across, _HIGHLIGHT * side)
    highlight: _Mask = gap & above & ~zones.neck & (brightness > 0.4)
    return highlight


def _find_short_gaps(area: _Mask, direction: NDArray[Any], longest: float) -> _Mask:
    """Gaps in an area that are at most so long in a direction (x, y)."""
    step, count = direction / max(1e-6, np.linalg.norm(direction)), max(1, round(longest))
    before, after = (np.full(area.shape, count + 1, np.int32) for _ in range(2))
    for distance in range(count, 0, -1):
        before[_shift(area, distance * step)] = distance
        after[_shift(area, -distance * step)] = distance
    return (before + after <= count + 1) & ~area


def _shift(area: _Mask, offset: NDArray[Any]) -> _Mask:
    """Shift an area by an offset (x, y) that is rounded to pixels."""
    x, y = np.rint(offset).astype(int).tolist()
    shifted = np.zeros_like(area)
    height, width = area.shape
    if abs(x) < width and abs(y) < height:
        target = slice(max(0, y), height + min(0, y)), slice(max(0, x), width + min(0, x))
        source = slice(max(0, -y), height + min(0, -y)), slice(max(0, -x), width + min(0, -x))
        shifted[target] = area[source]
    return shifted
