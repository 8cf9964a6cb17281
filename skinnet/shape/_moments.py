"""Sums over correspondences that are all a separable fit needs of the vertices."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

CHUNK = 1024
"""Vertices whose sums are made at once, in float64 whatever the model's own precision."""


@dataclass(frozen=True)
class Moments:
    """Weighted inner products between the columns of a fit's design and of its data.

    The design is Phi = [Q, 1 (x) I]: S modes and a translation, P = S + 3 columns. The data are ten
    columns: the nine e_j x_k, of which any rotation of the data points is a combination, and the
    mean shape. Neither depends on the pose, so a fit that has these sums never passes over the
    vertices again (Alotaibi & Smith 2017, equations 5 to 8, in the model's rotated frame).
    """

    design: Float[np.ndarray, "columns columns"]
    cross: Float[np.ndarray, "columns 10"]
    data: Float[np.ndarray, "10 10"]
    origin: Float[np.ndarray, "3"]
    """Point taken off all data points, for the sake of rounding."""


def gather(
    basis: Float[np.ndarray, "modes vertices 3"],
    mean: Float[np.ndarray, "vertices 3"],
    points: Float[np.ndarray, "vertices 3"],
    weights: Float[np.ndarray, "vertices"] | None = None,
    normals: Float[np.ndarray, "vertices 3"] | None = None,
    sliding: float = 0.0,
) -> Moments:
    """Sums of the correspondences mean_i + Q_i alpha <-> points_i.

    `weights` (None: 1) multiply the squared residuals. With `normals`, unit vectors in the model's
    frame, a residual along the surface counts only `sliding` of one across it:
    W_i = w_i (n n^T + sliding (I - n n^T)).
    """
    weights = np.ones(len(mean)) if weights is None else weights
    origin = weights @ points / weights.sum()
    split = len(basis) + 3
    total = np.zeros((split + 10, split + 10))
    for rows, columns in _chunks(basis, mean, points - origin, np.sqrt(weights)):
        flat = columns.reshape(len(columns), -1)
        if normals is None:
            total += flat @ flat.T
            continue
        across = np.einsum("pvj,vj->pv", columns, normals[rows])
        total += (1 - sliding) * (across @ across.T)
        if sliding > 0:
            total += sliding * (flat @ flat.T)
    return Moments(total[:split, :split], total[:split, split:], total[split:, split:], origin)


def _chunks(
    basis: Float[np.ndarray, "modes vertices 3"],
    mean: Float[np.ndarray, "vertices 3"],
    points: Float[np.ndarray, "vertices 3"],
    root: Float[np.ndarray, "vertices"],
) -> Iterator[tuple[slice, Float[np.ndarray, "columns chunk 3"]]]:
    """Weighted columns: modes, translations, the nine e_j x_k with j the slower, and the mean."""
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
