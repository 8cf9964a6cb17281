"""The noise of the regions' colours in a frame, of all its causes but light and gloss."""

import numpy as np
from numpy.typing import NDArray

from skinnet.video._baseline import Baseline, ComparedFrame
from skinnet.video._noise import RunningNoise
from skinnet.video._slow_errors import SlowErrors

_CHROMA_BY_BEND = 0.05
"""Standard deviation of log colour for each unit of bend, by which the mesh slides on the skin."""

_MOST_FACTOR = 25.0
"""Largest factor on the noise by the spread of the baseline; more is a movement."""

Array = NDArray[np.float64]


class FrameNoise:
    """Covariance of log RGB of the regions, learnt from the frames; its memory does not grow.

    Compression holds errors over many frames, which differences between them do not see; the spread
    of the baseline does.

    Args:
        baseline: The face at rest.
        inside: Which texels of the texture are covered, bool [size, size].
        frames: Time and colours of the baseline's frames.
    """

    def __init__(
        self,
        baseline: Baseline,
        inside: NDArray[np.bool_],
        frames: list[tuple[float, ComparedFrame]],
    ) -> None:
        self._noise = RunningNoise(len(baseline.regions))
        self._slow = SlowErrors(baseline.regions, inside)
        for time, compared in frames:
            self.add(time, compared)
        ratios = np.stack([compared.ratios for _, compared in frames])
        self._factor = _compare_spreads(ratios, self._noise.covariance)

    def add(self, time: float, compared: ComparedFrame) -> None:
        """Learn from a frame; from one that is no later than the last, nothing."""
        if time > self._noise.time:
            self._noise.add(time, compared.ratios)
            self._slow.add(time, compared.texels, compared.seen)

    def find_covariance(self, bend: float) -> Array:
        """The covariance now, [regions, 3, 3], where the mesh is bent by so much."""
        sliding = (_CHROMA_BY_BEND * bend) ** 2 * np.eye(3)
        return np.asarray(self._factor * self._noise.covariance + self._slow.covariance + sliding)


def _compare_spreads(ratios: Array, noise: Array) -> Array:
    """Variance of chroma in a baseline over that of its noise, at least 1, [regions, 1, 1]."""
    seen = np.asarray(np.isfinite(ratios).all(2))
    factors = np.ones((ratios.shape[1], 1, 1))
    for region, own in enumerate(seen.T):
        if own.sum() > 5:
            whole = np.cov(ratios[own, region].T)
            factors[region] = max(1.0, _measure_chroma(whole) / _measure_chroma(noise[region]))
    return np.asarray(np.minimum(factors, _MOST_FACTOR))


def _measure_chroma(covariance: Array) -> float:
    """Variance of what channels do not share."""
    return float(max(np.trace(covariance) - covariance.mean() * 3, 1e-12))
