"""A change of pigment as a change of colour, carried over to the photograph's full size."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.box import Box
from skinnet.images.resizing import resize
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8

UNTOUCHED, WHOLLY = 0.25, 0.75
"""Masks between which an edit sets in; pixels below the first keep their exact values."""

FADE = 0.08
"""Share of the box over which an edit fades out towards an edge inside the photograph."""

_DARK = 1e-3
"""Linear sRGB added to both colours of a ratio, so that black does not blow it up."""


def colour_gain(
    before: NDArray[np.float32], after: NDArray[np.float32], mask: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Ratio of two linear sRGB images [h, w, 3], smoothed over skin, as `mask` [h, w] weighs it."""
    gain = (after + _DARK) / (before + _DARK)
    weight = mask + 1e-4
    total = ndimage.gaussian_filter(weight, 1.0)
    for channel in range(3):
        change = ndimage.gaussian_filter(weight * (gain[..., channel] - 1), 1.0)
        gain[..., channel] = 1 + change / total
    return gain.astype(np.float32)


def edge_fade(shape: tuple[int, ...], box: Box, photo: tuple[int, ...]) -> NDArray[np.float32]:
    """Weights [h, w] that fall to 0 at the box's edges, except where those are the photograph's.

    A neck that leaves the box would else end in a straight line.
    """
    rows = _ramp(shape[0], box.top > 0, box.bottom < photo[0])
    columns = _ramp(shape[1], box.left > 0, box.right < photo[1])
    return np.outer(rows, columns).astype(np.float32)


def _ramp(count: int, rising: bool, falling: bool) -> NDArray[np.float64]:
    place = (np.arange(count) + 0.5) / count / FADE
    rise = place if rising else np.ones(count)
    fall = place[::-1] if falling else np.ones(count)
    return np.minimum(np.minimum(rise, fall), 1)


def apply_gain(
    crop: NDArray[np.uint8],
    gain: NDArray[np.float32],
    specular: NDArray[np.float32],
    mask: NDArray[np.float32],
) -> NDArray[np.uint8]:
    """uint8 sRGB [H, W, 3] with the light from inside the skin multiplied by `gain` [h, w, 3].

    edited = photo + soft (photo - specular)_+ (gain - 1) in linear sRGB, where `soft` rises from 0
    to 1 between masks of UNTOUCHED and WHOLLY; `specular` and `mask`
    [h, w] belong to the network's size, as `gain` does, and are brought to the crop's.
    """
    height, width = crop.shape[:2]
    soft = ((resize(mask, width, height) - UNTOUCHED) / (WHOLLY - UNTOUCHED)).clip(0, 1)
    gloss = resize(specular, width, height)
    linear = srgb_to_linear(crop)
    edited = crop.copy()
    for channel in range(3):
        photo = linear[..., channel]
        change = resize(np.ascontiguousarray(gain[..., channel]), width, height) - 1
        changed = photo + soft * np.maximum(photo - gloss, 0) * change
        edited[..., channel] = to_uint8(linear_to_srgb(changed))
    return np.where(soft[..., None] == 0, crop, edited)
