"""Melanin through a shot: looks of the network that are spread over it, and pooled."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_SPACING = 2.0
"""Seconds between two looks after the baseline, at first."""

_MOST = 16
"""Looks after the baseline that are kept at most; then every second one goes, and the seconds
between two are doubled."""

_LEAST = 1e-4
_CUT, _LEAST_SPREAD, _ROUNDS = 1.5, 0.01, 3
"""Deviation, in robust standard deviations of at least .01, from which on a look counts for less
(Huber 1964)."""

Array = NDArray[np.float64]


class MelaninLook(NamedTuple):
    """Melanin in one frame.

    Attributes:
        time: Time stamp in seconds.
        logs: Natural logarithms of the fraction of each covered texel, float32 [texels].
        share: Share of the face's skin at rest that the network takes for skin in this frame.
    """

    time: float
    logs: NDArray[np.float32]
    share: float


class PooledMelanin(NamedTuple):
    """Melanin of a shot.

    Attributes:
        texels: Fraction of each covered texel, [texels].
        times: Time stamps of the looks, [looks].
        means: Mean fraction of the face in each, [looks].
        weights: How much each counts, with sum 1, [looks].
    """

    texels: NDArray[np.float32]
    times: Array
    means: Array
    weights: Array


class LookSeries:
    """Keeps a bounded number of looks, however long the shot is.

    The head turns and the light on it changes, and the network's reading of melanin with them, but
    melanin does not: a mean over all poses is nearer to it than the reading of any few seconds.
    """

    def __init__(self) -> None:
        self._first: list[MelaninLook] = []
        self._later: list[MelaninLook] = []
        self._spacing, self._due = _SPACING, np.inf

    def start(self, time: float) -> None:
        """Begin to spread looks from a time on, the end of the baseline."""
        self._due = time + self._spacing

    def is_due(self, time: float) -> bool:
        """Whether it is time for another look."""
        return time >= self._due

    def postpone(self, time: float) -> None:
        """Wait for the next look, whether this one could be read or not."""
        self._due = time + self._spacing

    def add(
        self,
        time: float,
        melanin: NDArray[np.float32],
        share: float,
    ) -> None:
        """Add the melanin [texels] of a frame."""
        look = MelaninLook(time, np.log(np.maximum(melanin, np.float32(_LEAST))), share)
        if np.isinf(self._due):
            self._first.append(look)
            return
        self._later.append(look)
        if len(self._later) > _MOST:
            del self._later[1::2]
            self._spacing *= 2

    def pool(self, face: NDArray[np.bool_]) -> PooledMelanin:
        """Pool all looks; a look counts as much as the time that it stands for.

        Args:
            face: Texels of the face's skin, [texels].
        """
        looks = [*self._first, *self._later]
        times = np.array([one.time for one in looks])
        logs = np.stack([one.logs for one in looks])
        stands_for = np.gradient(times) if len(looks) > 1 else np.ones(1)
        weights = np.maximum(stands_for, 1e-3) * np.array([one.share for one in looks])
        weights = _lower_outliers(logs[:, face].mean(1).astype(np.float64), weights)
        texels = np.exp(weights @ logs).astype(np.float32)
        return PooledMelanin(
            texels, times, np.exp(logs[:, face]).mean(1).astype(np.float64), weights
        )


def _lower_outliers(levels: Array, weights: Array) -> Array:
    """Weights with sum 1, lower for levels far from the rest."""
    weights = np.maximum(weights, 1e-9)
    robust = weights / weights.sum()
    for _ in range(_ROUNDS):
        deviation = np.abs(levels - robust @ levels)
        spread = max(1.4826 * float(np.median(deviation)), _LEAST_SPREAD)
        robust = weights * np.minimum(1, _CUT * spread / np.maximum(deviation, 1e-9))
        robust = robust / robust.sum()
    return np.asarray(robust)


def describe_constancy(shots: list[tuple[int, PooledMelanin]]) -> dict[str, object]:
    """Describe how constant the readings of melanin are, for JSON.

    Args:
        shots: Numbers of the shots, and what was pooled in each.

    Returns:
        `looks` with the face's `mean` at their times; `spread`, the standard deviation of their
        logarithms about that of their shot; `standard_error` of the pooled mean's logarithm, as if
        looks were independent; and `drift`, by how much the logarithm differs between the second
        and the first half of the longest shot's looks. None where there are too few.
    """
    looks = [
        {"time": round(float(time), 3), "shot": number, "mean": round(float(mean), 5)}
        for number, pooled in shots
        for time, mean in zip(pooled.times, pooled.means, strict=True)
    ]
    spreads = [_measure_spread(pooled) for _, pooled in shots if len(pooled.times) > 1]
    longest = max((pooled for _, pooled in shots), key=lambda one: np.ptp(one.times), default=None)
    count = [1 / float((pooled.weights**2).sum()) for _, pooled in shots]
    spread = float(np.sqrt(np.mean(np.square(spreads)))) if spreads else None
    return {
        "looks": looks,
        "spread": None if spread is None else round(spread, 4),
        "standard_error": None if spread is None else round(spread / math.sqrt(sum(count)), 4),
        "drift": None if longest is None else _measure_drift(longest),
    }


def _measure_spread(pooled: PooledMelanin) -> float:
    logs = np.log(pooled.means)
    own = pooled.weights @ (logs - pooled.weights @ logs) ** 2
    return float(np.sqrt(own / max(1 - float((pooled.weights**2).sum()), 1e-3)))


def _measure_drift(pooled: PooledMelanin) -> float | None:
    middle = (pooled.times[0] + pooled.times[-1]) / 2
    halves = [pooled.times < middle, pooled.times >= middle]
    if min(int(half.sum()) for half in halves) < 2:
        return None
    first, second = (
        float(np.average(np.log(pooled.means[half]), weights=pooled.weights[half]))
        for half in halves
    )
    return round(second - first, 4)
