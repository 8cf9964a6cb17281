"""Mean and spread of the pigments in the regions of a face."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._face_parts import FaceRegion

_LEAST_PIXELS = 30
"""Least pixels of skin of a region whose pigments are given."""

_LEAST_SHARE = 0.3
"""Least part of a region that is skin; of less it is uncertain whether hair or cloth is read."""


class PigmentSummary(NamedTuple):
    """A pigment in a region; all None if too little of the region is skin.

    Attributes:
        mean: Mean volume fraction.
        std: Standard deviation over pixels.
        median: Median.
    """

    mean: float | None = None
    std: float | None = None
    median: float | None = None


class RegionSummary(NamedTuple):
    """The pigments in a region of a face.

    Attributes:
        melanin: Melanin over the region's skin.
        hemoglobin: Hemoglobin over the region's skin.
        share: Part of the region that is skin and inside the photograph, in [0, 1].
        pixels: Number of pixels of skin.
    """

    melanin: PigmentSummary
    hemoglobin: PigmentSummary
    share: float
    pixels: int

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        pigments = {"melanin": self.melanin._asdict(), "hemoglobin": self.hemoglobin._asdict()}
        return {**pigments, "share": self.share, "pixels": self.pixels}


def summarise_region(
    region: FaceRegion, skin: NDArray[np.bool_], *pigments: NDArray[np.float32]
) -> RegionSummary:
    """Summarise melanin and hemoglobin [h, w], in the region's box, where there is skin."""
    read = region.patch.inside & skin
    pixels = int(read.sum())
    share = pixels / max(1, region.area)
    if pixels < _LEAST_PIXELS or share < _LEAST_SHARE:
        melanin = hemoglobin = PigmentSummary()
    else:
        melanin, hemoglobin = (_summarise(values[read]) for values in pigments)
    return RegionSummary(melanin, hemoglobin, _round(share), pixels)


def _summarise(values: NDArray[np.float32]) -> PigmentSummary:
    wide = values.astype(np.float64)
    numbers = wide.mean(), wide.std(), np.median(wide)
    return PigmentSummary(*(_round(float(number)) for number in numbers))


def _round(number: float) -> float:
    """Six significant digits."""
    return float(f"{number:.6g}")
