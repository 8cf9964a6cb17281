"""What a sequence of maps says of each frame: how local means and deviations have changed."""

import numpy as np
from numpy.typing import NDArray

from skinnet.appearance._blood_change import sample_field
from skinnet.appearance._local_statistics import measure_local

_LEAST, _LEAST_SHARE = 1e-4, 0.5
_LEAST_DEVIATION = 0.02
"""Local standard deviation of log hemoglobin at rest below which its ratio is not taken."""

Array = NDArray[np.float64]
Maps = NDArray[np.floating]


def measure_means(rest: Maps, maps: Maps, window: float, size: int) -> Array:
    """Measure the log change of the local mean.

    Args:
        rest: Hemoglobin at rest on the chart, [side, side]; NaN where it is not known.
        maps: Hemoglobin of the frames, [frames, side, side].
        window: Standard deviation of the local window in sides of the chart.
        size: Side of the model's fields.

    Returns:
        Changes, [frames, size * size]; NaN where they are not known.
    """
    sigma, rows = window * len(rest), []
    for one in maps:
        before, after, weight = _take_logs(rest, one)
        change, _ = measure_local(after - before, weight, sigma)
        share, _ = measure_local(weight, np.ones_like(weight), sigma)
        rows.append(_shrink(np.where(share > _LEAST_SHARE, change, np.nan), size))
    return np.stack(rows)


def measure_spreads(rest: Maps, maps: Maps, means: Array, window: float, size: int) -> Array:
    """Measure the relative change of the local standard deviation of log hemoglobin.

    It is the slope of the detail of a frame by that at rest. A ratio of standard deviations would
    count noise, and the bend of the mean's change, as detail.

    Args:
        rest: Hemoglobin at rest on the chart, [side, side]; NaN where it is not known.
        maps: Hemoglobin of the frames, [frames, side, side].
        means: The model's change of the mean in each frame, [frames, size * size].
        window: Standard deviation of the local window in sides of the chart.
        size: Side of the model's fields.

    Returns:
        Changes, [frames, size * size]; NaN where they are not known.
    """
    sigma, rows = window * len(rest), []
    for one, moved in zip(maps, means, strict=True):
        before, after, weight = _take_logs(rest, one)
        level, deviation = measure_local(before, weight, sigma)
        left = after - before - _resample(moved.reshape(size, size), len(rest))
        shared, _ = measure_local((before - level) * left, weight, sigma)
        share, _ = measure_local(weight, np.ones_like(weight), sigma)
        known = (deviation > _LEAST_DEVIATION) & (share > _LEAST_SHARE)
        slope = shared / np.maximum(deviation, _LEAST_DEVIATION) ** 2
        rows.append(_shrink(np.where(known, slope, np.nan), size))
    return np.stack(rows)


def _take_logs(rest: Maps, one: Maps) -> tuple[Array, Array, Array]:
    """Logarithms of both, and 1 where both are known."""
    weight = (np.isfinite(rest) & np.isfinite(one)).astype(np.float64)
    before, after = (
        np.log(np.maximum(np.nan_to_num(each).astype(np.float64), _LEAST)) for each in (rest, one)
    )
    return before, after, weight


def _shrink(values: Array, size: int) -> Array:
    return _resample(values, size).ravel()


def _resample(values: Array, size: int) -> Array:
    line = (np.arange(size) + 0.5) / size
    return sample_field(values, np.stack(np.meshgrid(line, line), -1)).astype(np.float64)
