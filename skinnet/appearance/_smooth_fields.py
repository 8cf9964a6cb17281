"""Regularisation of fitted fields: by their noise, and by the places around."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_ENOUGH = 0.25
"""Share of frames around a place that suffices for its own average."""

_NORMAL = 1.4826
"""Standard deviations in the median absolute value of normal errors."""

Array = NDArray[np.float64]


def shrink_fields(
    slopes: Array, design: Array, values: Array, seen: NDArray[np.bool_], ridge: float
) -> Array:
    """Draw each field to 0 by the share of its power that noise explains (James and Stein).

    Args:
        slopes: Fields, [names, places].
        design: Coefficients of the frames, [frames, names].
        values: What was fitted, [frames, places]; NaN where it is not known.
        seen: Places that count.
        ridge: As of the fit.
    """
    if not seen.any():
        return slopes
    residuals = np.abs(values[:, seen] - design @ slopes[:, seen])
    noise = np.mean((_NORMAL * np.nanmedian(residuals, 0)) ** 2)
    inverse = np.linalg.inv(design.T @ design + ridge * np.eye(design.shape[1]))
    power = np.mean(slopes[:, seen] ** 2, 1)
    share = 1 - noise * np.diag(inverse) / np.maximum(power, 1e-12)
    shrunk: Array = slopes * np.clip(share, 0, 1)[:, None]
    return shrunk


def smooth_fields(fields: Array, weight: Array, reach: float) -> Array:
    """Average fields [names, size * size] around each place, farther where there is no weight."""
    size = round(len(weight) ** 0.5)
    squares, share = fields.reshape(-1, size, size), weight.reshape(size, size)
    total, power = np.zeros_like(squares), np.zeros((size, size))
    while reach < 2 * size:
        left = np.maximum(_ENOUGH - power, 0) / _ENOUGH
        total += left * np.stack([ndimage.gaussian_filter(one, reach) for one in squares * share])
        power += left * ndimage.gaussian_filter(share, reach)
        reach *= 2
    return np.asarray((total / np.maximum(power, 1e-9)).reshape(len(fields), -1))


def sharpen_fields(fields: Array, window: float) -> Array:
    """Undo, to first order, that local means were measured in a window, in sides of the chart."""
    size = round(fields.shape[1] ** 0.5)
    squares = fields.reshape(-1, size, size)
    blurred = np.stack([ndimage.gaussian_filter(one, window * size) for one in squares])
    return np.asarray((2 * squares - blurred).reshape(len(fields), -1))
