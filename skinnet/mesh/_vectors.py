"""Arithmetic of vectors in arrays."""

import numpy as np
from jaxtyping import Float


def normalise(vectors: Float[np.ndarray, "*shape 3"]) -> Float[np.ndarray, "*shape 3"]:
    """Scale vectors to length one; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)


def measure_edges(
    corners: Float[np.ndarray, "*shape corners k"],
) -> Float[np.ndarray, "*shape corners"]:
    """Measure the distance from each corner of closed curves to the next."""
    return np.asarray(np.linalg.norm(np.roll(corners, -1, -2) - corners, axis=-1))
