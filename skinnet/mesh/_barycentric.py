"""Barycentric coordinates: gradients in the plane, and interpolation."""

import numpy as np
from jaxtyping import Float

EMPTY = 1e-12
"""A triangle whose height is less than about this share of its length counts as without area."""


def compute_barycentric_gradients(
    places: Float[np.ndarray, "triangles 3 2"],
) -> Float[np.ndarray, "triangles 3 2"]:
    """Compute the gradients along x and y of barycentric coordinate k; nan without an area."""
    ahead, behind = np.roll(places, -1, 1), np.roll(places, -2, 1)
    opposite = behind - ahead
    double = (opposite[:, 2, 0] * opposite[:, 0, 1] - opposite[:, 2, 1] * opposite[:, 0, 0])[
        :, None
    ]
    empty = np.abs(double) <= EMPTY * (opposite**2).sum((1, 2))[:, None]
    double = np.where(empty, np.nan, double)
    return np.stack([-opposite[..., 1] / double, opposite[..., 0] / double], -1)


def interpolate(
    barycentric: Float[np.ndarray, "points 3"], corners: Float[np.ndarray, "points 3 k"]
) -> Float[np.ndarray, "points k"]:
    """Interpolate values at the corners of triangles."""
    return np.asarray(np.einsum("pk,pkx->px", barycentric, corners))
