"""The fit of a dynamic model, and its error on frames that it has not seen."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.appearance._ridge import fit_places
from skinnet.appearance._sequence_statistics import measure_spreads
from skinnet.appearance._smooth_fields import sharpen_fields, shrink_fields, smooth_fields
from skinnet.appearance._time_course import LAGS, PULSE, follow

_HELD_OUT = 4
"""One of so many sequences is held out, or the last part of each, if there are fewer."""

_PATTERNS, _SWEEPS = 8, 2

_LEAST_GAIN = 1e-3
"""Share of the misfit that a lag must explain."""

_MEAN_SMOOTH, _SPREAD_SMOOTH = 0.8, 2.5
"""Reach in texels over which slopes are averaged; a ratio of deviations is less certain."""

_LEAST_SEEN = 0.4
"""Frames that must show a place for its own slopes to be used, in shares of the best seen one's."""

Array = NDArray[np.float64]


class Example(NamedTuple):
    """What is known of a sequence.

    Attributes:
        rest: Hemoglobin at rest on the chart, [side, side]; NaN where it is not known.
        maps: Hemoglobin of the frames, [frames, side, side].
        times: In seconds, [frames].
        amounts: Coefficients, [frames, names].
        means: Log changes of the local mean, [frames, size * size].
    """

    rest: NDArray[np.floating]
    maps: NDArray[np.floating]
    times: Array
    amounts: Array
    means: Array

    def cut(self, part: slice) -> "Example":
        """Some of its frames."""
        return Example(
            self.rest, self.maps[part], self.times[part], self.amounts[part], self.means[part]
        )

    def delay(self, seconds: Array) -> Array:
        """Responses [frames, names] to the coefficients with time constants [names]."""
        columns = zip(self.amounts.T, seconds.tolist(), strict=True)
        return np.stack([follow(column, self.times, lag) for column, lag in columns], 1)


def find_lags(names: Sequence[str], examples: Sequence[Example], ridge: float) -> Array:
    """Find time constants in seconds of all coefficients but the pulse, one after the other."""
    values = np.nan_to_num(np.concatenate([each.means for each in examples]))
    left, sizes, _ = np.linalg.svd(values, full_matrices=False)
    seen = left[:, :_PATTERNS] * sizes[:_PATTERNS]
    seconds = np.zeros(len(names))
    for _ in range(_SWEEPS):
        for index, name in enumerate(names):
            if name != PULSE:
                seconds[index] = _find_lag(index, seconds, examples, seen, ridge)
    return seconds


def _find_lag(
    index: int, seconds: Array, examples: Sequence[Example], seen: Array, ridge: float
) -> float:
    misfits = []
    for lag in LAGS:
        tried = seconds.copy()
        tried[index] = lag
        misfits.append(_measure_misfit(_join(examples, tried), seen, ridge))
    best = int(np.argmin(misfits))
    gain = 1 - misfits[best] / max(misfits[0], 1e-12)
    return LAGS[best] if gain > _LEAST_GAIN else LAGS[0]


def fit_means(examples: Sequence[Example], seconds: Array, ridge: float, window: float) -> Array:
    """Fit the change of the local mean per unit of each coefficient, [names, size * size]."""
    values = np.concatenate([each.means for each in examples])
    fields = _fit_fields(_join(examples, seconds), values, ridge, _MEAN_SMOOTH)
    return sharpen_fields(fields, window)


def fit_spreads(
    examples: Sequence[Example], means: Array, seconds: Array, ridge: float, window: float
) -> Array:
    """Fit the change of the local deviation per unit of each coefficient, [names, size * size]."""
    size = round(means.shape[1] ** 0.5)
    values = [
        measure_spreads(each.rest, each.maps, each.delay(seconds) @ means, window, size)
        for each in examples
    ]
    design = _join(examples, seconds)
    return _fit_fields(design, np.concatenate(values), ridge, _SPREAD_SMOOTH)


def measure_held_out(
    examples: Sequence[Example], seconds: Array, ridge: float, window: float
) -> dict[str, float]:
    """Fit one part of the frames, and measure the error of the log change on the others.

    Returns:
        `rmse`, `rest_rmse` (that of no change at all), `r` (correlation) and the number of
        `frames`.
    """
    training, test = _split(examples)
    fields = fit_means(training, seconds, ridge, window)
    size = round(fields.shape[1] ** 0.5)
    blurred = _blur(_join(test, seconds) @ fields, size, window)
    truth = np.concatenate([each.means for each in test])
    known = np.isfinite(truth)
    told, true = blurred[known], truth[known]
    varies = len(true) > 1 and told.std() > 0 and true.std() > 0
    return {
        "rmse": float(np.sqrt(np.mean((told - true) ** 2))) if len(true) else float("nan"),
        "rest_rmse": float(np.sqrt(np.mean(true**2))) if len(true) else float("nan"),
        "r": float(np.corrcoef(told, true)[0, 1]) if varies else float("nan"),
        "frames": len(truth),
    }


def _blur(fields: Array, size: int, window: float) -> Array:
    """What the local window makes of changes [frames, size * size]."""
    squares = fields.reshape(-1, size, size)
    return np.stack([ndimage.gaussian_filter(one, window * size).ravel() for one in squares])


def _split(examples: Sequence[Example]) -> tuple[list[Example], list[Example]]:
    if len(examples) >= _HELD_OUT:
        held_out = range(_HELD_OUT - 1, len(examples), _HELD_OUT)
        training = [each for index, each in enumerate(examples) if index not in held_out]
        return training, [examples[index] for index in held_out]
    ends = [max(1, round(len(each.times) * (1 - 1 / _HELD_OUT))) for each in examples]
    pairs = list(zip(examples, ends, strict=True))
    return (
        [each.cut(slice(None, end)) for each, end in pairs],
        [each.cut(slice(end, None)) for each, end in pairs],
    )


def _join(examples: Sequence[Example], seconds: Array) -> Array:
    return np.concatenate([each.delay(seconds) for each in examples])


def _fit_fields(design: Array, values: Array, ridge: float, smooth: float) -> Array:
    """Fit all places; those that few frames show follow the places around them."""
    slopes = fit_places(design, values, ridge)
    seen = np.isfinite(values).mean(0)
    weight = np.where(seen > _LEAST_SEEN * seen.max(), seen, 0)
    shrunk = shrink_fields(slopes, design, values, weight > 0, ridge)
    return smooth_fields(shrunk, weight, smooth)


def _measure_misfit(design: Array, values: Array, ridge: float) -> float:
    squares = design.T @ design + ridge * np.eye(design.shape[1])
    slopes = np.linalg.solve(squares, design.T @ values)
    return float(((values - design @ slopes) ** 2).sum())
