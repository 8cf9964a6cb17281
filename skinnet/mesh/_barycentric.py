"""Barycentric coordinates in the plane."""

import numpy as np
from jaxtyping import Float

EMPTY = 1e-12
"""A triangle whose height is less than about this share of its length has no area."""


def barycentric_gradients(
    places: Float[np.ndarray, "triangles 3 2"],
) -> Float[np.ndarray, "triangles 3 2"]:
    """Gradient along x and y of barycentric coordinate k; nan for a triangle without an area."""
    ahead, behind = np.roll(places, -1, 1), np.roll(places, -2, 1)
    opposite = behind - ahead
    double = (opposite[:, 2, 0] * opposite[:, 0, 1] - opposite[:, 2, 1] * opposite[:, 0, 0])[
        :, None
    ]
    empty = np.abs(double) <= EMPTY * (opposite**2).sum((1, 2))[:, None]
    double = np.where(empty, np.nan, double)
    return np.stack([-opposite[..., 1] / double, opposite[..., 0] / double], -1)
