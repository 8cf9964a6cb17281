"""Moments of correspondences: the sums over vertices that a separable fit needs."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

CHUNK = 1024
"""Vertices that are summed at once, in float64 whatever the model's own precision."""


@dataclass(frozen=True)
class Moments:
    """Weighted inner products of the columns of A and y in Equation 6 of Alotaibi & Smith 2017.

    The data are rotated into the model's frame, which changes no residual because R is orthogonal.
    There A has the columns Phi = [Q, 1 (x) I], S modes and a translation, for the linear parameters
    s alpha and R^T t. y is a combination of ten columns: the nine e_j x_k, of which every rotation
    of the data points is a combination, and the mean shape. No column depends on the pose, so a fit
    that has these sums needs no further pass over the vertices.
    """

    design: Float[np.ndarray, "columns columns"]
    cross: Float[np.ndarray, "columns 10"]
    data: Float[np.ndarray, "10 10"]
    origin: Float[np.ndarray, "3"]
    """Weighted mean of the data points, subtracted from them to limit rounding errors."""


def compute_moments(
    basis: Float[np.ndarray, "modes vertices 3"],
    mean: Float[np.ndarray, "vertices 3"],
    points: Float[np.ndarray, "vertices 3"],
    weights: Float[np.ndarray, "vertices"] | None = None,
    normals: Float[np.ndarray, "vertices 3"] | None = None,
    sliding: float = 0.0,
) -> Moments:
    """Compute the moments of the correspondences mean_i + Q_i alpha <-> points_i.

    `weights` (None: 1) multiply the squared residuals. With `normals`, unit vectors in the model's
    frame, a residual along the surface counts only `sliding` times as much as one across it:
    W_i = w_i (n n^T + sliding (I - n n^T)). The moments give A^T A and A^T y of Equation 6 of
    Alotaibi & Smith 2017.
    """
    weights = np.ones(len(mean)) if weights is None else weights
    origin = weights @ points / weights.sum()
    split = len(basis) + 3
    total = np.zeros((split + 10, split + 10))
    for rows, columns in _iterate_chunks(basis, mean, points - origin, np.sqrt(weights)):
        flat = columns.reshape(len(columns), -1)
        if normals is None:
            total += flat @ flat.T
            continue
        across = np.einsum("pvj,vj->pv", columns, normals[rows])
        total += (1 - sliding) * (across @ across.T)
        if sliding > 0:
            total += sliding * (flat @ flat.T)
    return Moments(total[:split, :split], total[:split, split:], total[split:, split:], origin)


def _iterate_chunks(
    basis: Float[np.ndarray, "modes vertices 3"],
    mean: Float[np.ndarray, "vertices 3"],
    points: Float[np.ndarray, "vertices 3"],
    root: Float[np.ndarray, "vertices"],
) -> Iterator[tuple[slice, Float[np.ndarray, "columns chunk 3"]]]:
    """Yield weighted columns: modes, translations, the nine e_j x_k (j is slower), the mean."""
    modes = len(basis)
    buffer = np.zeros((modes + 13, min(CHUNK, len(mean)), 3))
    for start in range(0, len(mean), CHUNK):
        rows = slice(start, min(start + CHUNK, len(mean)))
        scale = root[rows, None]
        columns = buffer[:, : len(scale)]
        np.multiply(basis[:, rows], scale, out=columns[:modes])
        for j in range(3):
            columns[modes + j, :, j] = root[rows]
            columns[modes + 3 + 3 * j : modes + 6 + 3 * j, :, j] = (points[rows] * scale).T
        columns[-1] = mean[rows] * scale
        yield rows, columns
