"""Colours of a chart's patches in a photograph."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HALF = 0.24
"""Half of the side of what is sampled of a patch, in distances between patches."""

_MOST_POINTS = 32

_CLIPPED, _CLIPPED_SHARE = 0.955, 0.02
"""Linear value from which a channel is saturated (250 of 255), and the share of a patch's pixels
that may be."""


_DARK = 0.03
"""Linear value that is added to a patch's mean, since dark patches are noisy."""


class PatchSamples(NamedTuple):
    """Mean colours of patches.

    Attributes:
        linear: Linear sRGB [n, 3]; NaN for a patch that is not wholly in the photograph.
        spread: Standard deviation of the patch's brightness, relative to the mean [n].
        clipped: Whether a channel is saturated [n].
    """

    linear: Array
    spread: Array
    clipped: NDArray[np.bool_]


def sample_patches(linear: NDArray[np.float32], homography: Array, cells: Array) -> PatchSamples:
    """Sample patches.

    Args:
        linear: Linear sRGB [H, W, 3].
        homography: [3, 3] from columns and rows of the chart to pixels.
        cells: Column and row of each patch [n, 2].
    """
    place = apply_homography(homography, np.array([(0.0, 0.0), (1, 0), (0, 1)]) + cells[:, None])
    side = np.hypot(*np.moveaxis(np.diff(place[:, :2], axis=1), -1, 0)).max()
    count = int(np.clip(side * _HALF * 2, 3, _MOST_POINTS))
    steps = np.linspace(0.5 - _HALF, 0.5 + _HALF, count)
    grid = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
    points = apply_homography(homography, cells[:, None] + grid)
    column, row = np.moveaxis(np.floor(points), -1, 0).astype(int)
    height, width = linear.shape[:2]
    inside = ((column >= 0) & (row >= 0) & (column < width) & (row < height)).all(1)
    pixels = linear[row.clip(0, height - 1), column.clip(0, width - 1)].astype(float)
    brightness = pixels.mean(-1)
    return PatchSamples(
        np.where(inside[:, None], _trim(pixels), np.nan),
        brightness.std(1) / (brightness.mean(1) + _DARK),
        (pixels >= _CLIPPED).any(-1).mean(1) > _CLIPPED_SHARE,
    )


def apply_homography(homography: Array, points: Array) -> Array:
    """Apply a homography [3, 3] to points [..., 2]."""
    moved = points @ homography[:, :2].T + homography[:, 2]
    return np.asarray(moved[..., :2] / moved[..., 2:])


def _trim(pixels: Array) -> Array:
    """Mean [n, 3] of the pixels [n, m, 3] whose brightness is not among the outer tenths."""
    brightness = pixels.mean(-1)
    low, high = np.percentile(brightness, (10, 90), axis=1)
    kept = (brightness >= low[:, None]) & (brightness <= high[:, None])
    return np.asarray((pixels * kept[..., None]).sum(1) / kept.sum(1)[:, None])
