"""Directions from which light may come, in the camera's axes."""

import numpy as np
from jaxtyping import Float

LOWEST_Z = -0.35
"""Smallest z of a direction. Light from further behind hardly reaches a surface that the camera
sees."""


def spread_directions(count: int) -> Float[np.ndarray, "{count} 3"]:
    """Spread unit vectors evenly over z > `LOWEST_Z`.

    Args:
        count: Number of vectors.

    Returns:
        The vectors, those nearest to the camera's direction first.

    Source:
        Fibonacci spiral.

    Example:
        >>> spread_directions(3).round(2)
        array([[ 0.63,  0.  ,  0.78],
               [-0.7 ,  0.64,  0.32],
               [ 0.09, -0.99, -0.12]])
    """
    k = np.arange(count)
    z = 1 - (1 - LOWEST_Z) * (k + 0.5) / count
    azimuth = k * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], 1)


LIGHT_DIRECTIONS = spread_directions(64)
LIGHT_DIRECTIONS.flags.writeable = False
