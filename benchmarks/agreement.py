"""How far readings of the same people agree: intraclass correlation and spreads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, pearsonr, spearmanr

from benchmarks.report import Results

DRAWS, SEED = 1000, 0
"""Samples of people for the intervals, and the seed of the sampling."""

Values = NDArray[np.floating]
"""One value for each person and photograph, [..., people, photographs]."""


class Variances(NamedTuple):
    """Components of variance between people and within them, [...]."""

    between: NDArray[np.floating]
    within: NDArray[np.floating]

    @property
    def icc(self) -> NDArray[np.floating]:
        """The share of the variance that is between people; NaN where nothing varies."""
        with np.errstate(invalid="ignore"):
            return self.between / (self.between + self.within)


def estimate_variances(values: Values) -> Variances:
    """Estimate components of variance by a one-way random model.

    MSB and MSW are the mean squares between and within people, over k photographs. The variance
    within people is MSW, that between them (MSB - MSW) / k, which may be negative. Their share is
    ICC(1,1) = (MSB - MSW) / (MSB + (k - 1) MSW), the intraclass correlation of single readings.

    Source:
        Shrout & Fleiss 1979, doi 10.1037/0033-2909.86.2.420.
    """
    people, count = values.shape[-2:]
    means = values.mean(-1, keepdims=True)
    grand = means.mean(-2, keepdims=True)
    between = count * ((means - grand) ** 2).sum((-2, -1)) / (people - 1)
    within = ((values - means) ** 2).sum((-2, -1)) / (people * (count - 1))
    return Variances((between - within) / count, within)


def measure_agreement(values: Values, draws: int = DRAWS, seed: int = SEED) -> Results | None:
    """Measure agreement over the people of whom all readings are finite.

    Args:
        values: Readings [people, photographs].
        draws: Samples of people, with replacement, for the interval.
        seed: Seed of the sampling.

    Returns:
        `icc` with its 95 % interval, the standard deviations within and between people, and the
        number of people; None for fewer than three, or if nothing varies.
    """
    values = values[np.isfinite(values).all(-1)]
    if len(values) < 3:
        return None
    found = estimate_variances(values)
    if np.isnan(found.icc):
        return None
    chosen = np.random.default_rng(seed).integers(0, len(values), (draws, len(values)))
    interval = np.nanquantile(estimate_variances(values[chosen]).icc, (0.025, 0.975))
    return {
        "icc": float(found.icc),
        "within_sd": float(np.sqrt(found.within)),
        "between_sd": float(np.sqrt(max(found.between, 0.0))),
        "icc_interval": interval.tolist(),
        "people": len(values),
    }


def compare_with_other(angle: Values, raw: Values) -> Results:
    """Compare the angle read in each photograph with the raw angle of the person's other one.

    Args:
        angle: Typology angles of the skin that is read [people, 2], in degrees.
        raw: Those of the uncorrected pixels.

    Returns:
        `rank_other` is Spearman's correlation. `validity` is Pearson's over the root of the raw
        angle's ICC, which is the correlation that a perfect reading would have.
    """
    seen = np.isfinite(angle).all(-1) & np.isfinite(raw).all(-1)
    angle, raw = angle[seen], raw[seen]
    mine, other = angle.ravel(), raw[:, ::-1].ravel()
    if len(angle) < 3 or np.ptp(mine) == 0:
        return {"rank_other": None, "validity": None}
    icc = float(estimate_variances(raw).icc)
    r = float(pearsonr(mine, other).statistic)
    rank = float(spearmanr(mine, other).statistic)
    return {"rank_other": rank, "validity": r / icc**0.5 if icc > 0 else None}


def measure_coverage(values: Values, sd: Values, level: float = 0.9) -> float | None:
    """Measure how often an interval for the difference of two readings holds zero.

    Args:
        values: Readings [people, 2].
        sd: Their standard deviations.
        level: Probability of the interval.
    """
    seen = np.isfinite(values).all(-1)
    bound = norm.ppf((1 + level) / 2) * np.hypot(*sd[seen].T)
    inside = np.abs(np.diff(values[seen], axis=-1)[:, 0]) <= bound
    return float(inside.mean()) if len(inside) else None
