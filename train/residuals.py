"""Errors of a network beside the standard deviations that it states, and the factors for these."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit
from scipy.stats import norm
from torch import Tensor

LEVEL = 0.9
"""Level of the intervals that are made right."""

_GROUPS = 6
_SOFTNESS, _STIFFNESS = 0.05, 0.001
"""Width in natural logarithms over which an error passes out of its interval, which makes coverage
smooth; and the weight of no change with the tone."""


class Residuals(NamedTuple):
    """Errors of natural logarithms of melanin and hemoglobin, and their stated deviations.

    `tone` is the tone of each face as it is read (`measure_tone`), and `true_tone` as it is.
    """

    error: Float[Tensor, "2 count"]
    deviation: Float[Tensor, "2 count"]
    tone: Float[Tensor, "count"]
    true_tone: Float[Tensor, "count"]

    def find_scale(self) -> tuple[Float[Tensor, "2"], Float[Tensor, "2 2"]]:
        """Find the factors with which a share `LEVEL` lies within, in each group of true tones.

        Returns:
            Factors at the middle tone, and coefficients of the tone and its square.
        """
        found = [self._fit(*one) for one in zip(self.error, self.deviation, strict=True)]
        coefficients = torch.tensor(np.stack(found)).to(self.error)
        return coefficients[:, 0].exp(), coefficients[:, 1:]

    def _fit(
        self, error: Float[Tensor, "count"], deviation: Float[Tensor, "count"]
    ) -> NDArray[np.float64]:
        most = norm.ppf((1 + LEVEL) / 2)
        excess = (error.abs().clamp_min(1e-9) / (most * deviation)).log().numpy()
        powers = np.stack([np.ones(len(self.tone)), self.tone, self.tone**2])
        edges = self.true_tone.quantile(torch.linspace(0, 1, _GROUPS + 1)[1:-1].to(self.true_tone))
        group = torch.bucketize(self.true_tone, edges).numpy()
        groups = [group == number for number in np.unique(group)]

        def measure_misfit(coefficients: NDArray[np.float64]) -> float:
            inside = expit((coefficients @ powers - excess) / _SOFTNESS)
            shares = np.array([inside[one].mean() for one in groups])
            return float(((shares - LEVEL) ** 2).sum() + _STIFFNESS * (coefficients[1:] ** 2).sum())

        start = [float(np.quantile(excess, LEVEL)), 0.0, 0.0]
        result: NDArray[np.float64] = minimize(measure_misfit, start, method="Nelder-Mead").x
        return result


def join_residuals(parts: Sequence[Residuals]) -> Residuals:
    """Join the residuals of several batches."""
    return Residuals(*(torch.cat(one, -1) for one in zip(*parts, strict=True)))
