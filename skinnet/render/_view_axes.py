"""Axes of a view from its angles."""

import numpy as np
from jaxtyping import Float


def compute_view_axes(yaw: float, pitch: float = 0.0) -> Float[np.ndarray, "3 3"]:
    """Compute the right, up and backward axes of a view of the origin.

    `yaw` and `pitch` are angles in degrees by which the viewpoint moves to the face's left and up.
    """
    a, b = np.deg2rad(yaw), np.deg2rad(pitch)
    back = np.array([np.sin(a) * np.cos(b), np.sin(b), np.cos(a) * np.cos(b)])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    return np.stack([right, np.cross(back, right), back])
