"""Directions of the rays that sample a light or the sky."""

import numpy as np
from jaxtyping import Float

from skinnet.mesh._vectors import normalise


def build_tangents(
    normals: Float[np.ndarray, "points 3"],
) -> tuple[Float[np.ndarray, "points 3"], Float[np.ndarray, "points 3"]]:
    """Build two unit vectors that are orthogonal to each normal and to each other."""
    steep = np.abs(normals[:, :1]) > 0.6
    axis = np.where(steep, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    right = normalise(np.cross(axis, normals))
    return right, np.cross(normals, right)


def rotate(
    x: float, y: float, angle: Float[np.ndarray, "points 1"]
) -> tuple[Float[np.ndarray, "points 1"], Float[np.ndarray, "points 1"]]:
    """Rotate a point of the plane about the origin by many angles in radians."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return x * cosine - y * sine, x * sine + y * cosine


def sample_disc(count: int) -> Float[np.ndarray, "count 2"]:
    """Spread points evenly over the unit disc in a sunflower spiral.

    Projected up to the hemisphere they are cosine-weighted directions (Malley's method).
    """
    number = np.arange(count)
    radius, angle = np.sqrt((number + 0.5) / count), number * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)
