"""Noise of the regions' colours, from the differences between successive frames."""

import numpy as np
from numpy.typing import NDArray

_SECONDS = 2.0
"""Time over which the covariance is averaged."""

_MOST = 16.0
"""Squared distance, in the covariance so far, at which a difference is cut: it is a movement."""

_FLOOR = 3e-4
"""Least standard deviation of a region's log colour: rounding to eight bits and compression."""

Array = NDArray[np.float64]


class RunningNoise:
    """Covariance of noise of log RGB [regions, 3, 3]; its memory does not grow.

    Half of the mean square of differences between neighbours in time is the variance of the noise,
    whatever changes slowly (von Neumann 1941).

    Attributes:
        time: Time of the last frame.
    """

    def __init__(self, regions: int) -> None:
        self._sum = np.zeros((regions, 3, 3))
        self._weight = np.zeros(regions)
        self._before = np.full((regions, 3), np.nan)
        self.time = -np.inf

    @property
    def covariance(self) -> Array:
        """The covariance now."""
        mean = self._sum / np.maximum(self._weight, 1e-9)[:, None, None]
        return np.asarray(mean + _FLOOR**2 * np.eye(3))

    def add(self, time: float, ratios: Array) -> None:
        """Add the log ratios [regions, 3] of a frame; NaN for what is not seen."""
        difference = (ratios - self._before) / np.sqrt(2)
        seen = np.isfinite(difference).all(1)
        fade = np.exp(-max(time - self.time, 0.0) / _SECONDS) if np.isfinite(self.time) else 0.0
        cut = self._limit(np.where(seen[:, None], difference, 0.0))
        self._sum = np.where(
            seen[:, None, None], fade * self._sum + cut[:, :, None] * cut[:, None, :], self._sum
        )
        self._weight = np.where(seen, fade * self._weight + 1, self._weight)
        self._before, self.time = ratios, time

    def _limit(self, difference: Array) -> Array:
        solved = np.linalg.solve(self.covariance, difference[..., None])[..., 0]
        squares = (difference * solved).sum(1)
        trusted = self._weight > 5
        factor = np.where(trusted, np.sqrt(np.minimum(1, _MOST / np.maximum(squares, 1e-12))), 1.0)
        return np.asarray(difference * factor[:, None])
