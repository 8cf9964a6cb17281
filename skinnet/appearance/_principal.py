"""Principal components of few subjects and very many features, a block of features at a time."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.linalg import eigh

from skinnet.appearance._feature_blocks import ArrayBlocks, FeatureBlocks
from skinnet.errors import InputError

MAX_COMPONENTS = 100
"""Components that are kept unless a number is asked for."""

RANK = 1e-10
"""Variance, relative to the first component's, below which a component is rounding."""

SAME = 1e-7
"""Standard deviation of scaled features below which all subjects are the same but for rounding."""


@dataclass(frozen=True, eq=False)
class PrincipalComponents:
    """x = mean + scales * (beta P), where beta_k has the variance `variances`[k] over subjects.

    `mean` [C, M] and `scales` [C] in the unit of each channel; `basis` [K, C, M], orthonormal over
    its last two axes, of scaled features; `variances` [K] of the scaled features, descending, of
    which all components together have `total`; `subjects` is how many they were learnt from.
    """

    mean: Float32[np.ndarray, "channels texels"]
    basis: Float32[np.ndarray, "components channels texels"]
    variances: Float[np.ndarray, "components"]
    scales: Float[np.ndarray, "channels"]
    total: float
    subjects: int

    def project(
        self, features: Float[np.ndarray, "channels texels"], covered: Bool[np.ndarray, "texels"]
    ) -> Float[np.ndarray, "components"]:
        """Coefficients beta [K] that come nearest on the covered texels (scaled least squares).

        Raises `InputError` if so few texels are covered that they do not determine beta.
        """
        known = np.where(covered, features, self.mean).astype(np.float32)
        right = self.project_blocks(ArrayBlocks(known.reshape(1, -1), len(known)))[0]
        if covered.all():
            return np.asarray(right)
        # P is orthonormal over all texels, so only those that are missing need a product.
        normal = np.eye(len(self.basis))
        for channel in range(len(self.mean)):
            missing = self.basis[:, channel, ~covered]
            normal -= missing @ missing.T
        if np.linalg.eigvalsh(normal)[0] < 1e-4:
            raise InputError(
                f"{covered.sum()} of the model's {covered.size} texels are covered, too few for "
                f"its {len(self.basis)} components; fit a model with fewer components."
            )
        return np.asarray(np.linalg.solve(normal, right))

    def project_blocks(self, columns: FeatureBlocks) -> Float[np.ndarray, "subjects components"]:
        """Beta of every row of features, which are those of the model's texels."""
        beta = np.zeros((columns.shape[0], len(self.basis)))
        start = 0
        for block in columns:
            place = slice(start, start := start + block.shape[2])
            for channel, scale in enumerate(self.scales):
                centred = (block[:, channel] - self.mean[channel, place]) / np.float32(scale)
                beta += centred @ self.basis[:, channel, place].T
        return beta

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Coefficients drawn from N(0, variances); the same seed draws the same."""
        return np.asarray(sample_normal(count, len(self.variances), seed) * np.sqrt(self.variances))


def sample_normal(
    count: int, components: int, seed: int
) -> Float[np.ndarray, "samples components"]:
    """Standard normal numbers; a row is the same however many rows follow."""
    return np.random.default_rng(seed).standard_normal((count, components))


def compute_grams(columns: FeatureBlocks) -> Float[np.ndarray, "channels subjects subjects"]:
    """Inner products between centred subjects, of each channel by itself, in float64."""
    subjects, channels, _ = columns.shape
    grams = np.zeros((channels, subjects, subjects))
    for block in columns:
        for channel in range(channels):
            centred = block[:, channel].astype(np.float64)
            centred -= centred.mean(0)
            grams[channel] += centred @ centred.T
    return grams


def combine_grams(
    grams: Float[np.ndarray, "channels subjects subjects"], scales: Float[np.ndarray, "channels"]
) -> Float[np.ndarray, "subjects subjects"]:
    """Inner products of features divided by their channel's scale."""
    return np.tensordot(scales**-2.0, grams, 1)


class Axes(NamedTuple):
    """Principal axes as mixtures of subjects: sum_j vectors[j, k] x_j / sqrt(lengths[k]).

    `vectors` [subjects, K] are unit eigenvectors of a centred Gram matrix and `lengths` [K] its
    eigenvalues, descending; those that are rounding are left out.
    """

    vectors: Float[np.ndarray, "subjects axes"]
    lengths: Float[np.ndarray, "axes"]


def compute_axes(gram: Float[np.ndarray, "subjects subjects"], most: int) -> Axes:
    """The first axes of a centred Gram matrix, at most that many."""
    count = len(gram)
    first = min(max(count - most, 0), count - 1)
    lengths, vectors = eigh(gram, subset_by_index=(first, count - 1))
    lengths, vectors = lengths[::-1], vectors[:, ::-1]
    kept = lengths > RANK * max(lengths[0], np.finfo(float).tiny)
    # An eigenvector has no sign of its own; without this one, files would differ from run to run.
    signs = np.sign(vectors[np.abs(vectors).argmax(0), np.arange(len(lengths))])
    return Axes((vectors * signs)[:, kept], lengths[kept])


def compute_components(
    columns: FeatureBlocks,
    grams: Float[np.ndarray, "channels subjects subjects"],
    scales: Float[np.ndarray, "channels"],
    components: int | None = None,
) -> PrincipalComponents:
    """The components of all subjects, from their `compute_grams`, in one more pass over them.

    Memory is that of the basis, 4 K C M bytes, and of a few blocks; the features' covariance is
    never made. None keeps all components up to `MAX_COMPONENTS`. Raises `InputError` for more
    components than the subjects span, and if the subjects do not differ.
    """
    gram = combine_grams(grams, scales)
    divisor = max(len(gram) - 1, 1)
    total = float(np.trace(gram)) / divisor
    if total < SAME**2 * columns.shape[1] * columns.shape[2]:
        raise InputError(f"A model needs subjects that differ; got {len(gram)} that do not.")
    axes = compute_axes(gram, MAX_COMPONENTS if components is None else components)
    if components is not None and not 1 <= components <= len(axes.lengths):
        raise InputError(_too_many(components, gram))
    mean, basis = _basis(columns, axes, scales)
    return PrincipalComponents(mean, basis, axes.lengths / divisor, scales, total, len(gram))


def _too_many(asked: int, gram: Float[np.ndarray, "subjects subjects"]) -> str:
    found = len(compute_axes(gram, len(gram)).lengths)
    return (
        f"{asked} components were asked for, and {len(gram)} subjects span {found}; ask for 1 to "
        f"{found}, or give more subjects."
    )


def _basis(
    columns: FeatureBlocks, axes: Axes, scales: Float[np.ndarray, "channels"]
) -> tuple[
    Float32[np.ndarray, "channels texels"], Float32[np.ndarray, "components channels texels"]
]:
    _, channels, texels = columns.shape
    mean = np.empty((channels, texels), np.float32)
    basis = np.empty((len(axes.lengths), channels, texels), np.float32)
    mixing = (axes.vectors / np.sqrt(axes.lengths)).T
    start = 0
    for block in columns:
        place = slice(start, start := start + block.shape[2])
        for channel, scale in enumerate(scales):
            values = block[:, channel].astype(np.float64)
            mean[channel, place] = centre = values.mean(0)
            basis[:, channel, place] = mixing @ ((values - centre) / scale)
    return mean, basis
