"""Log factors of pigments on charts: gaps are filled, shading is damped, borders fade."""

from functools import cache

import numpy as np
import torch
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt

from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.painting.facial_hair import cover_with_beard
from train.synthetic.scene import CHART_SIZE, BeardParameters
from train.synthetic.tensors import soft_step

Chart = Float[np.ndarray, "rows columns"]
Charts = Float[np.ndarray, "*samples rows columns"]
PigmentCharts = Float[np.ndarray, "pigments rows columns"]

DAMPING = 0.7
"""Share of the broad changes, and of the mean face's own structure, that is removed. The shading
of portraits is read as pigment, and it lies in the same places in all of them."""

_FADING = 14
"""Texels of the chart over which a skin fades towards the border of its model."""

_FILL_SCALES = ((3.0, 1.0), (8.0, 0.02), (24.0, 4e-4))
"""Standard deviations in texels of the Gaussians that fill gaps, and their weights. The wider ones
matter only where the narrower ones do not reach."""

_BROAD = 24.0
"""Standard deviation in texels of the blur that separates shading: a third of the face's width."""

_MAX_LOG_FACTOR = 0.8
"""Largest log factor, approached smoothly."""

_NOT_SKIN = ((0.34, 0.03, 0.23, 0.14), (0.35, 0.21, 0.31, 0.14), (0.08, -0.44, 0.12, 0.06),
             (0.0, -0.66, 0.24, 0.02))  # fmt: skip
"""Azimuth, elevation and half widths of eyes, brows, nostrils and the line between the lips."""

_LIPS = (0.0, -0.668, 0.24, 0.095)


def compute_log_factors(
    fractions: PigmentCharts, floor: Float[np.ndarray, "pigments 1 1"], weight: Chart, lips: Chart
) -> PigmentCharts:
    """Compute logarithms over the face's median, and fill what is not skin.

    Args:
        fractions: Volume fractions.
        floor: Fractions that are added before logarithms are taken.
        weight: Share of bare skin in [0, 1].
        lips: Share of lips in [0, 1].

    Returns:
        Log factors.
    """
    median = np.median(fractions[:, weight > 0.5], axis=1)[:, None, None]
    log = np.log((fractions + floor) / (median + floor))
    # Texels that are half brow or beard must not spread over the skin around them.
    return fill_gaps(log, weight, weight**4 * (1 - lips))


def fade_to_border(
    log: PigmentCharts, lips: Chart, inside: Bool[np.ndarray, "rows columns"]
) -> PigmentCharts:
    """Damp broad changes, limit the rest, and fade to 0 towards the border.

    Args:
        log: Log factors.
        lips: Share of lips in [0, 1].
        inside: Texels that the model knows.

    Returns:
        Log factors of mean 0.
    """
    log = log - DAMPING * _blur(log, inside * (1 - lips), _BROAD)
    log = _MAX_LOG_FACTOR * np.tanh(log / _MAX_LOG_FACTOR)
    depth = (distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1] / _FADING).clip(0, 1)
    border = depth**2 * (3 - 2 * depth)
    mean = (log * border).sum((1, 2)) / border.sum()
    return np.asarray(border * (log - mean[:, None, None]))


def fill_gaps(values: Charts, weight: Chart, source: Chart) -> Charts:
    """Keep values by their weight, and fill the rest from the nearest sources.

    Args:
        values: Any values.
        weight: Share in [0, 1] of the own value.
        source: Weight in [0, 1] with which a texel fills others.

    Returns:
        Values without gaps.
    """
    near, total = np.zeros_like(values), np.zeros_like(source)
    for width, share in _FILL_SCALES:
        near += share * _convolve(values * source, width)
        total += share * _convolve(source, width)
    return np.asarray(weight * values + (1 - weight) * near / np.maximum(total, 1e-9))


def _blur(values: Charts, weight: Chart, width: float) -> Charts:
    """Weighted means under a Gaussian of that standard deviation in texels."""
    total = np.maximum(_convolve(weight.astype(float), width), 1e-6)
    return np.asarray(_convolve(values * weight, width) / total)


def _convolve(values: Charts, width: float) -> Charts:
    # Two products are many times faster than a filter of this width.
    down, across = (_make_kernel(n, width) for n in values.shape[-2:])
    return np.asarray(down @ values @ across)


@cache
def _make_kernel(count: int, width: float) -> Float[np.ndarray, "n n"]:
    distance = np.arange(count)[:, None] - np.arange(count)
    return np.asarray(np.exp(-((distance / width) ** 2) / 2) / (width * np.sqrt(2 * np.pi)))


def find_bare_skin() -> tuple[Chart, Chart]:
    """Find where a chart may show bare skin, lips included, and where it has lips.

    Returns:
        Two shares in [0, 1].
    """
    azimuth, elevation = compute_chart_angles(*CHART_SIZE)
    lips = _evaluate_ellipse(*_LIPS)
    one = torch.tensor([1.0])
    full = BeardParameters(beard=one, moustache=one, stubble=0 * one, grain=one)
    hair = cover_with_beard(full, azimuth.abs(), elevation)
    skin = 1 - hair.reshape(*CHART_SIZE).numpy() * (1 - lips)
    for place in _NOT_SKIN:
        skin = skin * (1 - _evaluate_ellipse(*place))
    return skin, lips


def _evaluate_ellipse(centre: float, height: float, half_width: float, half_height: float) -> Chart:
    azimuth, elevation = compute_chart_angles(*CHART_SIZE)
    across = (azimuth.abs() - centre if centre else azimuth) / half_width
    inside = 1 - torch.hypot(across, (elevation - height) / half_height)
    return np.asarray(soft_step(inside, 0.2).numpy())
