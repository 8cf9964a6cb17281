"""A change of pigment as a change of colour, applied at the photograph's full size."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.box import Box
from skinnet.images.resizing import resize
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8

_RAMP_START, _RAMP_END = 0.25, 0.75
"""Masks between which changes set in; pixels below the first keep their exact values."""

_FADE = 0.08
"""Share of the box over which an edit fades out towards an edge inside the photograph."""

_RATIO_OFFSET = 1e-3
"""Linear sRGB added to both colours of a ratio, so that it stays finite at black."""


def soften_mask(mask: NDArray[np.float32]) -> NDArray[np.float32]:
    """A weight that rises linearly from 0 to 1 between masks of 0.25 and 0.75."""
    scale = np.float32(1 / (_RAMP_END - _RAMP_START))
    return ((mask - np.float32(_RAMP_START)) * scale).clip(0, 1)


def compute_gain(
    before: NDArray[np.float32], after: NDArray[np.float32], mask: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Ratio of two linear sRGB images [h, w, 3], smoothed over skin with the weights `mask`."""
    gain = (after + _RATIO_OFFSET) / (before + _RATIO_OFFSET)
    weight = mask + 1e-4
    total = ndimage.gaussian_filter(weight, 1.0)
    for channel in range(3):
        change = ndimage.gaussian_filter(weight * (gain[..., channel] - 1), 1.0)
        gain[..., channel] = 1 + change / total
    return gain.astype(np.float32)


def fade_edges(shape: tuple[int, ...], box: Box, photo: tuple[int, ...]) -> NDArray[np.float32]:
    """Weights [h, w] that fall to 0 at the box's edges, except at edges of the photograph.

    Without them, an edit of a neck that leaves the box would end in a straight line.
    """
    rows = _fade_axis(shape[0], box.top > 0, box.bottom < photo[0])
    columns = _fade_axis(shape[1], box.left > 0, box.right < photo[1])
    return np.outer(rows, columns).astype(np.float32)


def apply_gain(
    crop: NDArray[np.uint8],
    gain: NDArray[np.float32],
    specular: NDArray[np.float32],
    mask: NDArray[np.float32],
) -> NDArray[np.uint8]:
    """Multiply the diffuse reflection in uint8 sRGB [H, W, 3] by `gain` [h, w, 3].

    edited = photo + weight * max(photo - specular, 0) * (gain - 1) in linear sRGB, where the weight
    is that of `soften_mask`; `specular` and `mask` [h, w] have the size of `gain`, and all three
    are enlarged to that of the crop. Pixels of weight 0 keep their exact values.
    """
    height, width = crop.shape[:2]
    weight = soften_mask(resize(mask, width, height))
    specular = resize(specular, width, height)
    linear = srgb_to_linear(crop)
    edited = crop.copy()
    for channel in range(3):
        photo = linear[..., channel]
        change = resize(np.ascontiguousarray(gain[..., channel]), width, height) - 1
        changed = photo + weight * np.maximum(photo - specular, 0) * change
        edited[..., channel] = to_uint8(linear_to_srgb(changed))
    return np.where(weight[..., None] == 0, crop, edited)


def _fade_axis(count: int, at_start: bool, at_end: bool) -> NDArray[np.float64]:
    place = (np.arange(count) + 0.5) / count / _FADE
    start = place if at_start else np.ones(count)
    end = place[::-1] if at_end else np.ones(count)
    return np.minimum(np.minimum(start, end), 1)
