"""Means over pixels and photographs, and cube roots of fractions, for the losses."""

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn.functional import gaussian_nll_loss

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch height width"]
Scalar = Float[Tensor, ""]

_LEAST_FRACTION = 1e-3


def cube_root(fraction: Map, largest: float) -> Map:
    # The derivative of the cube root is infinite at zero.
    return (fraction / largest).clamp_min(1e-6) ** (1 / 3)


def weighted_mean(value: Map, weight: Map) -> Scalar:
    return mean_over(value, weight).mean()


def mean_over(value: Map, weight: Map) -> Float[Tensor, "batch"]:
    over = (-2, -1)
    return (value * weight).sum(over) / weight.sum(over).clamp_min(1)


def log_fraction(fraction: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    # Fractions of less have no visible effect.
    return fraction.clamp_min(_LEAST_FRACTION).log()


def log_mean(fraction: Map, weight: Map) -> Float[Tensor, "batch"]:
    return log_fraction(mean_over(fraction, weight))


def normal_score(error: Tensor, variance: Tensor) -> Tensor:
    """Negative log likelihood of normal errors, without its constant: log(v) / 2 + e^2 / 2 v."""
    return gaussian_nll_loss(error, torch.zeros_like(error), variance, reduction="none")
