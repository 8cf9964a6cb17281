"""The directions in which light may come, in the camera's axes."""

import numpy as np
from jaxtyping import Float

LOWEST = -0.35
"""Least z of a direction: light from further behind reaches little of what a camera sees."""


def spread(count: int) -> Float[np.ndarray, "{count} 3"]:
    """Unit vectors spread evenly over z > `LOWEST` on a Fibonacci spiral, the first ahead."""
    k = np.arange(count)
    z = 1 - (1 - LOWEST) * (k + 0.5) / count
    turn = k * np.pi * (3 - np.sqrt(5))
    around = np.sqrt(1 - z**2)
    return np.stack([around * np.cos(turn), around * np.sin(turn), z], 1)


DIRECTIONS = spread(64)
DIRECTIONS.flags.writeable = False
