"""Means over pixels and photographs, and cube roots of fractions, for the losses."""

from jaxtyping import Float
from torch import Tensor

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch height width"]
Scalar = Float[Tensor, ""]

_LEAST_FRACTION = 1e-3


def cube_root(fraction: Map, largest: float) -> Map:
    # The derivative of the cube root is infinite at zero.
    return (fraction / largest).clamp_min(1e-6) ** (1 / 3)


def weighted_mean(value: Map, weight: Map) -> Scalar:
    over = (-2, -1)
    return ((value * weight).sum(over) / weight.sum(over).clamp_min(1)).mean()


def mean_over(value: Map, weight: Map) -> Float[Tensor, "batch"]:
    over = (-2, -1)
    return (value * weight).sum(over) / weight.sum(over).clamp_min(1)


def log_fraction(fraction: Float[Tensor, "*shape"]) -> Float[Tensor, "*shape"]:
    # Fractions of less have no visible effect.
    return fraction.clamp_min(_LEAST_FRACTION).log()
