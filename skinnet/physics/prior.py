"""The distribution of skins: melanin, blood, and what varies besides."""

import json
from functools import cache
from importlib.resources import files
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics.nuisance import Nuisance

_TYPICAL_F_MEL = 0.12
"""Melanin at which the nuisance's regression has its origin."""


class SkinPrior:
    """Joint distribution of melanin, blood and nuisance over people, for the preset `measured`.

    ln f_mel and ln f_blood follow a mixture of normal distributions. Given them, the nuisance is
    normal about a mean that is linear in ln f_mel, and what is left over at each band is normal
    with a covariance that depends on ln f_mel.
    """

    def __init__(self) -> None:
        record = _read()
        as_tensor = torch.tensor
        self.weights = as_tensor(record["mixture"]["weights"], dtype=torch.float64)
        self.means = as_tensor(record["mixture"]["means"], dtype=torch.float64)
        self.covariances = as_tensor(record["mixture"]["covariances"], dtype=torch.float64)
        self.coefficients = as_tensor(record["nuisance"]["coefficients"], dtype=torch.float64)
        self.nuisance = as_tensor(record["nuisance"]["covariance"], dtype=torch.float64)
        self.tones = as_tensor(record["leftover"]["tones"], dtype=torch.float64)
        self.width = float(record["leftover"]["width"])
        self.leftover = as_tensor(record["leftover"]["covariances"], dtype=torch.float64)

    def log_density(
        self, f_mel: Float[Tensor, "*#batch"], f_blood: Float[Tensor, "*#batch"]
    ) -> Float[Tensor, "*batch"]:
        """Compute the logarithm of the density of (ln f_mel, ln f_blood)."""
        x = torch.stack(torch.broadcast_tensors(f_mel.log(), f_blood.log()), -1)
        mixture = torch.distributions.MixtureSameFamily(
            torch.distributions.Categorical(self.weights),
            torch.distributions.MultivariateNormal(self.means, self.covariances),
        )
        return mixture.log_prob(x)

    def condition(
        self, f_mel: Float[Tensor, "*batch"]
    ) -> tuple[Nuisance, Float[Tensor, "4 4"], Float[Tensor, "*batch wavelength wavelength"]]:
        """Return nuisance given melanin (mean, covariance), and the covariance of what is left."""
        tone = f_mel.log()
        design = torch.stack([torch.ones_like(tone), (f_mel / _TYPICAL_F_MEL).log()], -1)
        mean = design @ self.coefficients
        near = torch.exp(-0.5 * ((tone[..., None] - self.tones) / self.width) ** 2) + 1e-6
        near = near / near.sum(-1, keepdim=True)
        leftover = torch.einsum("...t,tij->...ij", near, self.leftover)
        return Nuisance(*mean.unbind(-1)), self.nuisance, leftover


@cache
def _read() -> dict[str, Any]:
    path = files("skinnet.physics") / "tables" / "prior.json"
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return record
