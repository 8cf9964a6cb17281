"""A pigment of a person, fused from several shots."""

from typing import Any, NamedTuple

import numpy as np

from skinnet.inference._fusion import Fusion
from skinnet.inference._index_summary import SkinIndices
from skinnet.inference._uncertainty import LEVEL, find_interval


class Agreement(NamedTuple):
    """Whether shots agree in a pigment.

    Attributes:
        q: Cochran's Q.
        degrees_of_freedom: Number of shots, less one.
        p: Probability that shots that agree have this Q or a larger one.
        birge_ratio: By how much the interval is widened, 1 or more.
    """

    q: float
    degrees_of_freedom: int
    p: float
    birge_ratio: float


class FusedPigment(NamedTuple):
    """A pigment in a region; all None, and no shots, if no shot shows enough of it.

    Attributes:
        mean: Mean volume fraction.
        sd: Its standard deviation.
        interval: Fractions between which the true mean lies with a probability of 90 %.
        shots: Number of shots that were fused.
        agreement: Whether they agree.
    """

    mean: float | None = None
    sd: float | None = None
    interval: tuple[float, float] | None = None
    shots: int = 0
    agreement: Agreement | None = None

    @property
    def log_sd(self) -> float:
        """Standard deviation of the natural logarithm; 0 where there is no mean."""
        return 0.0 if self.mean is None or self.sd is None else self.sd / self.mean

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        agreement = None if self.agreement is None else self.agreement._asdict()
        return {**self._asdict(), "agreement": agreement, "level": LEVEL}


class FusedRegion(NamedTuple):
    """The pigments in a region of the face.

    Attributes:
        melanin: Melanin, fused from the shots that show the region.
        hemoglobin: Hemoglobin, as of melanin.
        indices: Colour, typology angle and the like of skin with the mean pigments, with 90 %
            intervals; None if there are none, or the fractions are not of the preset `measured`.
    """

    melanin: FusedPigment
    hemoglobin: FusedPigment
    indices: SkinIndices | None = None

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        pigments = {"melanin": self.melanin.to_json(), "hemoglobin": self.hemoglobin.to_json()}
        return {**pigments, "indices": None if self.indices is None else self.indices.to_json()}


def make_pigment(fusion: Fusion, index: int, top: float) -> FusedPigment:
    """Make the fractions of one of the fused logarithms; `top` is the largest fraction."""
    value, log_sd, q, freedom, p, ratio = (field[index].item() for field in fusion)
    if not np.isfinite(value):
        return FusedPigment()
    mean = float(np.exp(value))
    low, high = find_interval(mean, log_sd, top)
    return FusedPigment(
        mean=round_number(mean),
        sd=round_number(mean * log_sd),
        interval=(round_number(low), round_number(high)),
        shots=freedom + 1,
        agreement=Agreement(round_number(q), freedom, round_number(p), round_number(ratio)),
    )


def round_number(number: float) -> float:
    """Six significant digits."""
    return float(f"{number:.6g}")
