"""Readings of one quantity in several shots as one, and whether they agree.

The reading of shot i is y_i = t + e_i: the logarithm of the true fraction and an error with the
standard deviation s_i that the shot states. Errors are not independent. What makes a person unlike
others, such as the depth from which skin returns light, errs alike in all shots: `shared` is the
correlation that this makes. Shots of one session, under one light and camera, are taken to err
wholly alike, with the correlation 1. That is the worst case: together they are no surer than one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import chdtrc

Array = NDArray[np.float64]

SHARED = {"melanin": 0.45, "hemoglobin": 0.65}
"""Correlation of the errors of two shots of one person under different light and cameras.

Measured on 104 synthetic faces, five captures each, as wide as photographs by anybody:
`synthetic.fused5.*.error_correlation` of `python -m benchmarks.constancy`.
"""


class Fusion(NamedTuple):
    """Readings [..., shots] that are fused; all are NaN where no shot is read.

    Attributes:
        value: Fused logarithm, [...].
        sd: Its standard deviation, widened by `birge_ratio`, [...].
        q: Cochran's Q: the sum of squared differences from the fused value, each divided by the
            part of its variance that the shots do not share.
        freedom: Degrees of freedom of Q: the shots that are read, less one.
        p: Probability that shots that agree have this Q or a larger one; 1 for a single shot.
        birge_ratio: Square root of Q over its degrees of freedom, and 1 at least: by how much
            shots differ more than they state.
    """

    value: Array
    sd: Array
    q: Array
    freedom: NDArray[np.intp]
    p: Array
    birge_ratio: Array


def fuse_readings(
    values: ArrayLike, sds: ArrayLike, shared: float = 0.0, sessions: ArrayLike | None = None
) -> Fusion:
    """Fuse readings by their inverse variances.

    Args:
        values: Natural logarithms of fractions, [..., shots]; NaN for shots that do not show it.
        sds: Standard deviations that the shots state of them, [..., shots].
        shared: Correlation of the errors of two sessions, in [0, 1).
        sessions: Number of the session of each shot, [..., shots]; None: each is one of its own.

    Returns:
        The mean with inverse variances as weights, and the standard deviation that it has if errors
        are correlated. Without sessions and with `shared` 0 it is a fixed-effect meta-analysis.

    Source:
        W. G. Cochran, The combination of estimates from different experiments, Biometrics 10,
        1954. R. T. Birge, The calculation of errors by the method of least squares, Physical
        Review 40, 1932; the Particle Data Group calls the ratio the scale factor S.
    """
    y, s = np.broadcast_arrays(np.asarray(values, float), np.asarray(sds, float))
    seen = np.isfinite(y) & np.isfinite(s)
    y, s = np.where(seen, y, 0.0), np.where(seen, s, 1.0)
    total = (seen / s**2).sum(-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        value = (seen * y / s**2).sum(-1) / total
        sd = _find_sd(seen / s, _correlate(seen, shared, sessions)) / total
    q = np.nan_to_num(seen * (y - value[..., None]) ** 2 / ((1 - shared) * s**2)).sum(-1)
    freedom = np.maximum(seen.sum(-1) - 1, 0)
    ratio = np.sqrt(np.maximum(q / np.maximum(freedom, 1), 1.0))
    p = np.where(freedom > 0, chdtrc(np.maximum(freedom, 1), q), 1.0)
    return Fusion(*map(np.asarray, (value, ratio * sd, q, freedom, p, ratio)))


def _correlate(seen: NDArray[np.bool_], shared: float, sessions: ArrayLike | None) -> Array:
    """Correlations of the errors of shots, [..., shots, shots]."""
    names = np.broadcast_to(np.arange(seen.shape[-1]) if sessions is None else sessions, seen.shape)
    return np.where(names[..., None] == names[..., None, :], 1.0, shared)


def _find_sd(weighted: Array, correlation: Array) -> Array:
    """Standard deviation of a sum of errors with these standard deviations, [...]."""
    return np.asarray(np.sqrt(np.einsum("...i,...ij,...j->...", weighted, correlation, weighted)))
