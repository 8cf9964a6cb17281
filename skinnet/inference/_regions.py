"""Mean and spread of the pigments in the regions of a face."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._face_parts import FaceRegion
from skinnet.inference._index_summary import SkinIndices
from skinnet.inference._uncertainty import find_interval
from skinnet.inference.indices import _find_indices

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
        sd: Standard deviation of the mean: how uncertain it is.
        interval: Fractions between which the true mean lies with a probability of 90 %.
    """

    mean: float | None = None
    std: float | None = None
    median: float | None = None
    sd: float | None = None
    interval: tuple[float, float] | None = None

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        return self._asdict() | {"interval": self.interval and list(self.interval)}


class RegionSummary(NamedTuple):
    """The pigments in a region of a face.

    Attributes:
        melanin: Melanin over the region's skin.
        hemoglobin: Hemoglobin over the region's skin.
        share: Part of the region that is skin and inside the photograph, in [0, 1].
        pixels: Number of pixels of skin.
        indices: Colour, typology angle and the like of skin with the mean pigments, with 90 %
            intervals; None if there are none, or the fractions are not of the preset `measured`.
    """

    melanin: PigmentSummary
    hemoglobin: PigmentSummary
    share: float
    pixels: int
    indices: SkinIndices | None = None

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        pigments = {"melanin": self.melanin.to_json(), "hemoglobin": self.hemoglobin.to_json()}
        indices = None if self.indices is None else self.indices.to_json()
        return {**pigments, "share": self.share, "pixels": self.pixels, "indices": indices}


class Pigment(NamedTuple):
    """A pigment over a region's box.

    Attributes:
        values: Volume fractions [h, w].
        log_sd: Standard deviation of the logarithm of the region's mean.
        top: Largest fraction.
    """

    values: NDArray[np.float32]
    log_sd: float
    top: float


def summarise_region(
    region: FaceRegion,
    read: NDArray[np.bool_],
    melanin: Pigment,
    hemoglobin: Pigment,
    optics: str | None = None,
) -> RegionSummary:
    """Summarise both pigments over the pixels [h, w] of the region's box that are read.

    `optics` is the preset to which the fractions belong.
    """
    pixels = int(read.sum())
    share = pixels / max(1, region.area)
    if pixels < _LEAST_PIXELS or share < _LEAST_SHARE:
        return RegionSummary(PigmentSummary(), PigmentSummary(), _round(share), pixels)
    of_melanin, of_hemoglobin = (_summarise(each, read) for each in (melanin, hemoglobin))
    means, log_sds = (of_melanin.mean, of_hemoglobin.mean), (melanin.log_sd, hemoglobin.log_sd)
    indices = _find_indices(optics, means, log_sds)
    return RegionSummary(of_melanin, of_hemoglobin, _round(share), pixels, indices)


def _summarise(pigment: Pigment, read: NDArray[np.bool_]) -> PigmentSummary:
    wide = pigment.values[read].astype(np.float64)
    mean = float(wide.mean())
    low, high = find_interval(mean, pigment.log_sd, pigment.top)
    return PigmentSummary(
        mean=_round(mean),
        std=_round(float(wide.std())),
        median=_round(float(np.median(wide))),
        sd=_round(mean * pigment.log_sd),
        interval=(_round(low), _round(high)),
    )


def _round(number: float) -> float:
    """Six significant digits."""
    return float(f"{number:.6g}")
