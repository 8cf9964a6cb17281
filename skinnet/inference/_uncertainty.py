"""How sure the pigments are, of pixels, regions and a face; and the intervals that follow."""

import math
from collections.abc import Mapping, Sequence
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._arguments import check_number
from skinnet.images.box import Box

PIGMENTS = ("melanin", "hemoglobin")

LEVEL = 0.9
"""Probability of the intervals in summaries and panels."""


class Uncertainty(NamedTuple):
    """Standard deviations of the natural logarithms of melanin and hemoglobin.

    What is read is the median of what may be true, and the error of its logarithm is Gaussian.

    Attributes:
        melanin: Of pixels, float32 [h, w]: the box at the network's resolution.
        hemoglobin: The same of hemoglobin.
        face: Of the means of melanin and hemoglobin over the skin.
        region_share: Of melanin and hemoglobin: how much of the variance that pixels have beyond
            that of the face remains in the mean of a region.
    """

    melanin: NDArray[np.float32]
    hemoglobin: NDArray[np.float32]
    face: tuple[float, float]
    region_share: tuple[float, float]

    @classmethod
    def from_outputs(
        cls, outputs: Mapping[str, NDArray[np.float32]], region_share: tuple[float, float]
    ) -> "Uncertainty":
        """Select it from the encoder's outputs for one photograph."""
        melanin, hemoglobin = (outputs[f"{pigment}_sd"][0] for pigment in PIGMENTS)
        face_melanin, face_hemoglobin = outputs["face_sd"][0].tolist()
        return cls(melanin, hemoglobin, (face_melanin, face_hemoglobin), region_share)

    def of_pixels(self, pigment: str) -> NDArray[np.float32]:
        """The map [h, w] of a pigment."""
        return dict(zip(PIGMENTS, self[:2], strict=True))[pigment]

    def of_region(self, box: Box, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> list[float]:
        """Standard deviations of the logarithms of both means over pixels of the photograph.

        The variance is the face's, and the share `region_share` of what pixels have beyond it.
        """
        height, width = self.melanin.shape
        down = ((rows - box.top) * height // box.height).clip(0, height - 1)
        across = ((columns - box.left) * width // box.width).clip(0, width - 1)
        variances = []
        for pixels, face, share in zip(self[:2], self.face, self.region_share, strict=True):
            mean = float(np.mean(pixels[down, across].astype(np.float64) ** 2))
            variances.append(face**2 + share * max(mean - face**2, 0.0))
        return [math.sqrt(variance) for variance in variances]


def find_interval(
    mean: float, log_sd: float, top: float, level: float = LEVEL
) -> tuple[float, float]:
    """Find between which fractions, of 0 to `top`, the true one lies with a probability."""
    factor = find_factor(log_sd, level)
    return min(mean / factor, top), min(mean * factor, top)


def find_factor(log_sd: float, level: float = LEVEL) -> float:
    """Find the factor by which what is read may be too large, or too small, at most.

    Raises:
        InputError: The level is no probability between 0 and 1.
    """
    level = check_number("The level of an interval", level)
    if not 0 < level < 1:
        raise InputError(
            f"The level of an interval is a probability between 0 and 1; got {level:g}. 0.9 gives "
            "the interval that holds the true value in nine of ten photographs."
        )
    return math.exp(NormalDist().inv_cdf((1 + level) / 2) * log_sd)


def describe_mean(mean: float, interval: Sequence[float]) -> str:
    """Describe a mean fraction with its 90 % interval."""
    low, high = interval
    return f"{mean:.2g} ({LEVEL:.0%}: {low:.2g} to {high:.2g})"


def describe_percent(mean: float, interval: Sequence[float]) -> str:
    """Describe a mean fraction with its interval in percent, as scales of maps are."""
    low, high = (100 * end for end in interval)
    return f"{100 * mean:.2g} % ({low:.2g} to {high:.2g} %)"


def summarise_mean(mean: float | None, log_sd: float, top: float) -> dict[str, Any]:
    """Summarise a mean fraction as numbers for JSON, None where there is no skin."""
    if mean is None:
        return {"mean": None, "sd": None, "interval": None, "level": LEVEL}
    low, high = find_interval(mean, log_sd, top)
    return {"mean": mean, "sd": mean * log_sd, "interval": [low, high], "level": LEVEL}
