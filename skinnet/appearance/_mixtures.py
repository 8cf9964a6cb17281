"""Faces as mixtures of the subjects that a model was learnt from.

Every reconstruction and every sample of a principal component analysis is sum_j w_j x_j with
weights of unit sum. The weights follow from inner products between subjects. A model without one
subject therefore needs an eigenproblem as large as the number of subjects, and no pass over the
features.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._principal import compute_axes

MixtureErrors = Callable[
    [Float[np.ndarray, "mixtures subjects"]], Float[np.ndarray, "mixtures subjects"]
]
"""Computes the RMS difference between each mixture, given by its weights, and each subject."""


class LeftOut(NamedTuple):
    """Inner products about the mean of all subjects but one.

    `gram` are those between these subjects, `cross` those with the subject that is left out.
    """

    gram: Float[np.ndarray, "others others"]
    cross: Float[np.ndarray, "others"]


def leave_out(gram: Float[np.ndarray, "subjects subjects"], index: int) -> LeftOut:
    """Compute the inner products without one subject; `gram` may have any centre."""
    others = np.delete(np.arange(len(gram)), index)
    between, cross = gram[np.ix_(others, others)], gram[others, index]
    mean = between.mean(0)
    return LeftOut(
        between - mean - mean[:, None] + mean.mean(), cross - mean - cross.mean() + mean.mean()
    )


def project_left_out(
    products: LeftOut, counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "counts others"]:
    """Compute the weights, less those of the mean, that reconstruct the subject left out.

    They are sum_k u_k (u_k . cross) / length_k, with one row for each number of components.
    """
    vectors, lengths = compute_axes(products.gram, int(counts.max()))
    steps = vectors * (vectors.T @ products.cross / lengths)
    return _sum_first(steps.T, counts)


def weigh_samples(
    gram: Float[np.ndarray, "subjects subjects"],
    normal: Float[np.ndarray, "samples components"],
    counts: Int[np.ndarray, "counts"],
) -> Float[np.ndarray, "samples counts subjects"]:
    """Compute the weights, less those of the mean, of random faces from standard normal numbers.

    beta_k = z_k deviation_k has the weights z_k u_k / sqrt(n - 1), with one row for each number of
    components.
    """
    vectors, _ = compute_axes(gram, int(counts.max()))
    steps = normal[:, : vectors.shape[1], None] * vectors.T / np.sqrt(len(gram) - 1)
    return np.stack([_sum_first(step, counts) for step in steps])


def reconstruct_subjects(
    gram: Float[np.ndarray, "subjects subjects"], counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "subjects counts subjects"]:
    """Compute the weights, less those of the mean, that reconstruct each subject of the set."""
    vectors, _ = compute_axes(gram, int(counts.max()))
    return np.stack([_sum_first((vectors * own).T, counts) for own in vectors])


def _sum_first(
    steps: Float[np.ndarray, "components subjects"], counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "counts subjects"]:
    """Sum the first rows, as many as each count; a count above their number sums all rows."""
    sums = np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps, 0)])
    return np.asarray(sums[np.minimum(counts, len(steps))])


def compute_errors(
    gram: Float[np.ndarray, "subjects subjects"], weights: Float[np.ndarray, "mixtures subjects"]
) -> Float[np.ndarray, "mixtures subjects"]:
    """Compute the distance between each mixture and each subject, given a centred Gram matrix."""
    own = np.einsum("mj,mj->m", weights @ gram, weights)
    squares = own[:, None] - 2 * weights @ gram + np.diag(gram)
    return np.asarray(np.sqrt(np.maximum(squares, 0)))
