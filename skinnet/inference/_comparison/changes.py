"""Changes of pigments with their intervals."""

import math
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._uncertainty import LEVEL

_JOINT = -2 * math.log(1 - LEVEL)
"""Quantile of chi-squared with two degrees of freedom."""


class Change(NamedTuple):
    """The change of a pigment from one photograph to another one.

    Attributes:
        log: Natural logarithm of the factor by which its fraction has changed.
        sd: Its standard deviation.
    """

    log: float
    sd: float

    @property
    def interval(self) -> tuple[float, float]:
        """Logarithms between which the true one lies with a probability of 90 %."""
        reach = NormalDist().inv_cdf((1 + LEVEL) / 2) * self.sd
        return self.log - reach, self.log + reach

    @property
    def percent(self) -> float:
        """The change in percent of the first fraction."""
        return to_percent(self.log)

    @property
    def unchanged(self) -> bool:
        """Whether no change lies in the interval."""
        low, high = self.interval
        return low <= 0 <= high

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        ends = list(self.interval)
        return {
            "log": round(self.log, 4),
            "sd": round(self.sd, 4),
            "interval": [round(end, 4) for end in ends],
            "percent": round(self.percent, 1),
            "percent_interval": [round(to_percent(end), 1) for end in ends],
            "unchanged": self.unchanged,
        }


class PigmentChanges(NamedTuple):
    """The changes of both pigments in a face or in a region.

    Attributes:
        melanin: Change of melanin.
        hemoglobin: Change of hemoglobin.
        unchanged: Whether no change of both lies in the ellipse that holds the true changes with a
            probability of 90 %.
    """

    melanin: Change
    hemoglobin: Change
    unchanged: bool

    @classmethod
    def from_moments(
        cls, mean: NDArray[np.float64], covariance: NDArray[np.float64]
    ) -> "PigmentChanges":
        """Make them from the mean [2] and covariance [2, 2] of both logarithms."""
        distance = float(mean @ np.linalg.solve(covariance, mean))
        melanin, hemoglobin = (
            Change(log, sd)
            for log, sd in zip(mean.tolist(), np.sqrt(np.diag(covariance)).tolist(), strict=True)
        )
        return cls(melanin, hemoglobin, distance <= _JOINT)

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        return {
            "melanin": self.melanin.to_json(),
            "hemoglobin": self.hemoglobin.to_json(),
            "unchanged": self.unchanged,
        }


class RegionChanges(NamedTuple):
    """The changes in a region of the face.

    Attributes:
        total: Changes of its pigments. They are as uncertain as those of the face.
        against_rest: By how much more its pigments have changed than those of all other skin that
            is compared; light and camera matter little to it.
    """

    total: PigmentChanges
    against_rest: PigmentChanges

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        return self.total.to_json() | {"against_rest": self.against_rest.to_json()}


def to_percent(log: float) -> float:
    """The change in percent of a log factor."""
    return 100 * math.expm1(log)
