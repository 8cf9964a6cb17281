"""A change of pigment as a change of colour, applied at the photograph's full size."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images._guided_filter import enlarge_rows
from skinnet.images.box import Box
from skinnet.images.picture import Picture

_RAMP_START, _RAMP_END = 0.1, 0.9
"""Masks between which changes set in; pixels below the first keep their exact values."""

FADE = 0.08
"""Share of the box over which an edit fades out towards an edge inside the photograph."""

_RATIO_OFFSET = 1e-3
"""Linear sRGB added to both colours of a ratio, so that it stays finite at black."""

_STRIP = 128
"""Rows that are edited at once, which bounds the memory."""


class ColourChange(NamedTuple):
    """A change of diffuse reflection: loss * colour + gain * (R + G + B), both [h, w, 3].

    A channel that becomes darker is multiplied by the ratio of the model's colours. A channel that
    becomes lighter gets what the model gains, at the brightness of the photograph, and keeps what
    the model does not explain. Multiplied, this would grow: dark skin, whose blue is little and is
    predicted to be less, would turn blue.
    """

    loss: NDArray[np.float32]
    gain: NDArray[np.float32]


class ColourMeans(NamedTuple):
    """Mean colours of what was edited, weighed by how much of the edit each pixel got.

    Attributes:
        weight: Sum of the weights, in pixels.
        before: Linear sRGB before the edit, in [0, 1], [3]; NaN if nothing was edited.
        after: The same after it.
    """

    weight: float
    before: NDArray[np.float64]
    after: NDArray[np.float64]


def soften_mask(mask: NDArray[np.float32]) -> NDArray[np.float32]:
    """A weight that rises linearly from 0 to 1 between masks of 0.1 and 0.9."""
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
    crop: Picture,
    change: ColourChange,
    specular: NDArray[np.float32],
    mask: NDArray[np.float32],
    share: NDArray[Any] | None = None,
) -> ColourMeans:
    """Change the diffuse reflection in a picture [H, W] by `change` [h, w], in its own pixels.

    The diffuse reflection is max(photo - specular, 0) in linear sRGB. The change is weighed by
    `soften_mask`; `specular` [h, w] has the size of `change`, `mask` any, and all three are
    enlarged to that of the crop. Pixels of weight 0, and transparent ones, keep their exact values.

    Args:
        crop: The picture, which is changed.
        change: Change of the colours of skin.
        specular: Specular reflection in linear sRGB.
        mask: Probability of skin.
        share: How much of the edit each pixel gets, [H, W], as `to_share` reads it; None for all.

    Returns:
        The mean colours before and after.
    """
    pixels = crop.pixels
    planes = [*np.moveaxis(np.concatenate(change, -1), -1, 0), specular, mask]
    sums = np.zeros(7)
    for top in range(0, pixels.shape[0], _STRIP):
        rows = slice(top, min(top + _STRIP, pixels.shape[0]))
        *parts, weight = (enlarge_rows(plane, pixels.shape[:2], rows) for plane in planes)
        skin = soften_mask(weight)
        if share is not None:
            skin = skin * to_share(share[rows])
        if crop.alpha is not None:
            skin[crop.alpha[rows] == 0] = 0
        place = skin > 0
        if place.any():
            here = replace(crop, pixels=pixels[rows][place][None], alpha=None)
            inside = [part[place] for part in (*parts, skin)]
            old, new, pixels[rows][place] = _change_pixels(here, inside)
            sums += [inside[-1].sum(), *(inside[-1] @ old), *(inside[-1] @ new)]
    means = sums[1:] / (sums[0] or np.nan)
    return ColourMeans(float(sums[0]), means[:3], means[3:])


def to_share(values: NDArray[Any]) -> NDArray[np.float32]:
    """Shares in [0, 1] from bool, integers of 8 or 16 bits without a sign, or floats in [0, 1]."""
    top = np.iinfo(values.dtype).max if values.dtype.kind == "u" else 1
    return np.asarray(values.astype(np.float32) / np.float32(top), np.float32)


def _change_pixels(
    here: Picture, parts: list[NDArray[np.float32]]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[Any]]:
    """Change the pixels [1, N, C] of a picture.

    `parts` are six planes of change, specular reflection and the weight, each [N]. Returns linear
    sRGB [N, 3] in [0, 1] before and after, and stored values [N, C].
    """
    change, specular, weight = np.stack(parts[:6], -1), parts[6][:, None], parts[7][:, None]
    linear = here.linear()[0]
    diffuse = np.maximum(linear - specular, 0)
    added = change[:, :3] * diffuse + change[:, 3:] * diffuse.sum(-1, keepdims=True)
    changed = (added != 0).any(-1)
    edited = linear + weight * added
    values: NDArray[Any] = here.with_linear(edited[None], changed[None]).pixels[0]
    return linear.clip(0, 1), edited.clip(0, 1), values


def _fade_axis(count: int, at_start: bool, at_end: bool) -> NDArray[np.float64]:
    place = (np.arange(count) + 0.5) / count / FADE
    start = place if at_start else np.ones(count)
    end = place[::-1] if at_end else np.ones(count)
    return np.minimum(np.minimum(start, end), 1)
