"""Faces as mixtures of the subjects that a model was learnt from.

Whatever a principal component analysis reconstructs or draws is sum_j w_j x_j with weights of unit
sum, and the weights follow from inner products between subjects. So leaving a subject out needs an
eigenproblem of the size of the subjects and no pass over the features.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._principal import compute_axes

Errors = Callable[[Float[np.ndarray, "mixtures subjects"]], Float[np.ndarray, "mixtures subjects"]]
"""RMS differences between mixtures, of the weights given, and each of the subjects."""


class LeftOut(NamedTuple):
    """Inner products when one subject is left out, about the mean of the others.

    `gram` [n - 1, n - 1] between the others, `cross` [n - 1] of each with the one left out.
    """

    gram: Float[np.ndarray, "others others"]
    cross: Float[np.ndarray, "others"]


def leave_out(gram: Float[np.ndarray, "subjects subjects"], index: int) -> LeftOut:
    """The inner products of a set without one of its subjects; `gram` may have any centre."""
    others = np.delete(np.arange(len(gram)), index)
    between, cross = gram[np.ix_(others, others)], gram[others, index]
    mean = between.mean(0)
    return LeftOut(
        between - mean - mean[:, None] + mean.mean(), cross - mean - cross.mean() + mean.mean()
    )


def project_left_out(
    products: LeftOut, counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "counts others"]:
    """Changes of the weights, from those of the mean, that reconstruct the one left out.

    One row for each number of components of the others; sum_k u_k (u_k . cross) / length_k.
    """
    vectors, lengths = compute_axes(products.gram, int(counts.max()))
    steps = vectors * (vectors.T @ products.cross / lengths)
    return _cumulative(steps.T, counts)


def weigh_samples(
    gram: Float[np.ndarray, "subjects subjects"],
    normal: Float[np.ndarray, "samples components"],
    counts: Int[np.ndarray, "counts"],
) -> Float[np.ndarray, "samples counts subjects"]:
    """Changes of the weights, from those of the mean, of random faces with standard normal numbers.

    One row for each number of components: beta_k = z_k deviation_k is a mixture with
    z_k u_k / sqrt(n - 1).
    """
    vectors, _ = compute_axes(gram, int(counts.max()))
    steps = normal[:, : vectors.shape[1], None] * vectors.T / np.sqrt(len(gram) - 1)
    return np.stack([_cumulative(step, counts) for step in steps])


def reconstruct_subjects(
    gram: Float[np.ndarray, "subjects subjects"], counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "subjects counts subjects"]:
    """Changes of the weights, from those of the mean, that reconstruct each subject of the set."""
    vectors, _ = compute_axes(gram, int(counts.max()))
    return np.stack([_cumulative((vectors * own).T, counts) for own in vectors])


def _cumulative(
    steps: Float[np.ndarray, "components subjects"], counts: Int[np.ndarray, "counts"]
) -> Float[np.ndarray, "counts subjects"]:
    """Sums of the first rows, as many as there are if more are asked for."""
    sums = np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps, 0)])
    return np.asarray(sums[np.minimum(counts, len(steps))])


def errors(
    gram: Float[np.ndarray, "subjects subjects"], weights: Float[np.ndarray, "mixtures subjects"]
) -> Float[np.ndarray, "mixtures subjects"]:
    """Distance of each mixture from each subject in the space of a centred Gram matrix."""
    own = np.einsum("mj,mj->m", weights @ gram, weights)
    squares = own[:, None] - 2 * weights @ gram + np.diag(gram)
    return np.asarray(np.sqrt(np.maximum(squares, 0)))
