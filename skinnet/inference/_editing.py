"""A change of pigment as a change of colour, applied at the photograph's full size."""

from typing import NamedTuple

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


class ColourChange(NamedTuple):
    """A change of diffuse reflection: loss * colour + gain * (R + G + B), both [h, w, 3].

    A channel that becomes darker is multiplied by the ratio of the model's colours. A channel that
    becomes lighter gets what the model gains, at the brightness of the photograph, and keeps what
    the model does not explain. Multiplied, this would grow: dark skin, whose blue is little and is
    predicted to be less, would turn blue.
    """

    loss: NDArray[np.float32]
    gain: NDArray[np.float32]


def soften_mask(mask: NDArray[np.float32]) -> NDArray[np.float32]:
    """A weight that rises linearly from 0 to 1 between masks of 0.25 and 0.75."""
    scale = np.float32(1 / (_RAMP_END - _RAMP_START))
    return ((mask - np.float32(_RAMP_START)) * scale).clip(0, 1)


def compute_change(
    before: NDArray[np.float32], after: NDArray[np.float32], mask: NDArray[np.float32]
) -> ColourChange:
    """Change between two linear sRGB images [h, w, 3], smoothed over skin with weights `mask`."""
    loss = np.minimum((after + _RATIO_OFFSET) / (before + _RATIO_OFFSET), 1) - 1
    gain = np.maximum(after - before, 0) / (before.sum(-1, keepdims=True) + _RATIO_OFFSET)
    change = np.concatenate([loss, gain], -1).astype(np.float32)
    weight = mask + 1e-4
    share = ndimage.gaussian_filter(weight, 1.0)
    for channel in range(6):
        change[..., channel] = ndimage.gaussian_filter(weight * change[..., channel], 1.0) / share
    return ColourChange(change[..., :3], change[..., 3:])


def fade_edges(shape: tuple[int, ...], box: Box, photo: tuple[int, ...]) -> NDArray[np.float32]:
    """Weights [h, w] that fall to 0 at the box's edges, except at edges of the photograph.

    Without them, an edit of a neck that leaves the box would end in a straight line.
    """
    rows = _fade_axis(shape[0], box.top > 0, box.bottom < photo[0])
    columns = _fade_axis(shape[1], box.left > 0, box.right < photo[1])
    return np.outer(rows, columns).astype(np.float32)


def apply_change(
    crop: NDArray[np.uint8],
    change: ColourChange,
    specular: NDArray[np.float32],
    mask: NDArray[np.float32],
) -> NDArray[np.uint8]:
    """Change the diffuse reflection in uint8 sRGB [H, W, 3] by `change` [h, w].

    The diffuse reflection is max(photo - specular, 0) in linear sRGB. The change is weighed by
    `soften_mask`; `specular` and `mask` [h, w] have the size of `change`, and all three are
    enlarged to that of the crop. Pixels of weight 0 keep their exact values.
    """
    height, width = crop.shape[:2]
    weight = soften_mask(resize(mask, width, height))
    specular = resize(specular, width, height)
    linear = srgb_to_linear(crop)
    diffuse = np.maximum(linear - specular[..., None], 0)
    total = diffuse.sum(-1)
    edited = crop.copy()
    for channel in range(3):
        loss, gain = (
            resize(np.ascontiguousarray(part[..., channel]), width, height) for part in change
        )
        changed = linear[..., channel] + weight * (loss * diffuse[..., channel] + gain * total)
        edited[..., channel] = to_uint8(linear_to_srgb(changed))
    return np.where(weight[..., None] == 0, crop, edited)


def _fade_axis(count: int, at_start: bool, at_end: bool) -> NDArray[np.float64]:
    place = (np.arange(count) + 0.5) / count / _FADE
    start = place if at_start else np.ones(count)
    end = place[::-1] if at_end else np.ones(count)
    return np.minimum(np.minimum(start, end), 1)
