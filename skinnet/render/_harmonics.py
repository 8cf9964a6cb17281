"""Real spherical harmonics."""

import numpy as np
from jaxtyping import Float

COSINE_LOBE = np.repeat([1, 2 / 3, 1 / 4], [1, 3, 5])
"""A_l / pi of the clamped cosine for each of the nine harmonics of degree l = 0, 1 and 2
(Ramamoorthi & Hanrahan 2001, equation 8)."""


def evaluate_harmonics(directions: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 9"]:
    """Evaluate the nine real spherical harmonics up to degree 2 at unit directions."""
    x, y, z = directions.T
    one = np.sqrt(3 / (4 * np.pi))
    two = np.sqrt(15 / (4 * np.pi))
    return np.stack(
        [
            np.full_like(x, np.sqrt(1 / (4 * np.pi))),
            *(one * y, one * z, one * x),
            *(two * x * y, two * y * z, np.sqrt(5 / (16 * np.pi)) * (3 * z * z - 1)),
            *(two * x * z, two / 2 * (x * x - y * y)),
        ],
        1,
    )
