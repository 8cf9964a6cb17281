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
_LIGHT, _WHITE = 0, 3
"""Flags on which factors depend: those of a known light, and of a known white."""

_SOFTNESS, _STIFFNESS = 0.05, 0.001
"""Width in natural logarithms over which an error passes out of its interval, which makes coverage
smooth; and the weight of no change with the tone or with what is known."""


class Residuals(NamedTuple):
    """Errors of natural logarithms of melanin and hemoglobin, and their stated deviations.

    `tone` is the tone of each face as it is read (`measure_tone`), `true_tone` as it is, and
    `known` flags what is known of its capture.
    """

    error: Float[Tensor, "2 count"]
    deviation: Float[Tensor, "2 count"]
    tone: Float[Tensor, "count"]
    true_tone: Float[Tensor, "count"]
    known: Float[Tensor, "count flags"]

    def find_scale(
        self,
    ) -> tuple[Float[Tensor, "2"], Float[Tensor, "2 2"], Float[Tensor, "2 flags"]]:
        """Find the factors with which a share `LEVEL` lies within, in each group of faces.

        Groups are six of true tones, and those whose capture is not known, whose white is, and
        whose light is.

        Returns:
            Factors at the middle tone where nothing is known, and in their logarithms the
            coefficients of the tone and its square, and of the flags.
        """
        found = [self._fit(*one) for one in zip(self.error, self.deviation, strict=True)]
        coefficients = torch.tensor(np.stack(found)).to(self.error)
        by_known = torch.zeros(2, self.known.shape[1]).to(self.error)
        by_known[:, [_LIGHT, _WHITE]] = coefficients[:, 3:]
        return coefficients[:, 0].exp(), coefficients[:, 1:3], by_known

    def _fit(
        self, error: Float[Tensor, "count"], deviation: Float[Tensor, "count"]
    ) -> NDArray[np.float64]:
        most = norm.ppf((1 + LEVEL) / 2)
        excess = (error.abs().clamp_min(1e-9) / (most * deviation)).log().numpy()
        told = self.known[:, [_LIGHT, _WHITE]].mT
        powers = np.stack([np.ones(len(self.tone)), self.tone, self.tone**2, *told])
        groups = [*self._group_by_tone(), *self._group_by_known()]

        def measure_misfit(coefficients: NDArray[np.float64]) -> float:
            inside = expit((coefficients @ powers - excess) / _SOFTNESS)
            shares = np.array([inside[one].mean() for one in groups])
            return float(((shares - LEVEL) ** 2).sum() + _STIFFNESS * (coefficients[1:] ** 2).sum())

        start = np.zeros(len(powers))
        start[0] = np.quantile(excess, LEVEL)
        result: NDArray[np.float64] = minimize(measure_misfit, start, method="Powell").x
        return result

    def _group_by_tone(self) -> list[NDArray[np.bool_]]:
        edges = self.true_tone.quantile(torch.linspace(0, 1, _GROUPS + 1)[1:-1].to(self.true_tone))
        group = torch.bucketize(self.true_tone, edges).numpy()
        return [group == number for number in np.unique(group)]

    def _group_by_known(self) -> list[NDArray[np.bool_]]:
        """Nothing known, white without light, and light; those of them that there are."""
        known = self.known.numpy() > 0
        light, white = known[:, _LIGHT], known[:, _WHITE]
        groups = [~known.any(1), white & ~light, light]
        return [one for one in groups if one.any()]


def join_residuals(parts: Sequence[Residuals]) -> Residuals:
    """Join the residuals of several batches."""
    *rest, known = zip(*parts, strict=True)
    return Residuals(*(torch.cat(one, -1) for one in rest), torch.cat(known))
