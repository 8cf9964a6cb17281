"""Means over pixels and photographs, and cube roots of fractions, for the losses."""

from jaxtyping import Float
from torch import Tensor

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch height width"]
Scalar = Float[Tensor, ""]


def cube_root(fraction: Map, largest: float) -> Map:
    # The derivative of the cube root is infinite at zero.
    return (fraction / largest).clamp_min(1e-6) ** (1 / 3)


def weighted_mean(value: Map, weight: Map) -> Scalar:
    over = (-2, -1)
    return ((value * weight).sum(over) / weight.sum(over).clamp_min(1)).mean()
