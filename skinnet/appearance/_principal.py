"""Principal components of few subjects and very many features (section 5 of the paper).

They come from the Gram matrix of the subjects, as large as their number. The covariance of the
features is never made, and features are read one block at a time.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32
from scipy.linalg import eigh

from skinnet.appearance._feature_blocks import ArrayBlocks, FeatureBlocks
from skinnet.errors import InputError, _check_count

MAX_COMPONENTS = 100
"""Largest number of components that are kept if no number is given."""

RANK = 1e-10
"""Variance, relative to the first component's, below which a component is rounding error."""

SAME = 1e-7
"""Standard deviation of scaled features below which subjects differ by rounding errors only."""


@dataclass(frozen=True, eq=False)
class PrincipalComponents:
    """The model x = mean + scales * (beta P), where beta_k has the variance `variances[k]`.

    `mean` and `scales` have the unit of each channel. `basis` is P, for scaled features,
    orthonormal over its last two axes. `variances` are those of scaled features, in descending
    order; `total` is the sum over all components, kept or not. `subjects` is their number.

    Source:
        Equation 10 of Alotaibi & Smith 2017.
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
        """Compute the coefficients beta by scaled least squares on the covered texels.

        Raises:
            InputError: If too few texels are covered to determine beta.
        """
        known = np.where(covered, features, self.mean).astype(np.float32)
        right = self.project_blocks(ArrayBlocks(known.reshape(1, -1), len(known)))[0]
        if covered.all():
            return np.asarray(right)
        # P is orthonormal over all texels, so only the missing texels need a product.
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

    def project_blocks(self, blocks: FeatureBlocks) -> Float[np.ndarray, "subjects components"]:
        """Compute the coefficients beta of every subject."""
        beta = np.zeros((blocks.shape[0], len(self.basis)))
        start = 0
        for block in blocks:
            place = slice(start, start := start + block.shape[2])
            for channel, scale in enumerate(self.scales):
                centred = (block[:, channel] - self.mean[channel, place]) / np.float32(scale)
                beta += centred @ self.basis[:, channel, place].T
        return beta

    def sample(self, count: int, seed: int) -> Float[np.ndarray, "samples components"]:
        """Sample coefficients from N(0, variances)."""
        return np.asarray(sample_normal(count, len(self.variances), seed) * np.sqrt(self.variances))


def sample_normal(
    count: int, components: int, seed: int
) -> Float[np.ndarray, "samples components"]:
    """Sample standard normal numbers; a row does not depend on the number of rows."""
    _check_count("count", count)
    _check_count("seed", seed)
    return np.random.default_rng(seed).standard_normal((count, components))


def compute_grams(blocks: FeatureBlocks) -> Float[np.ndarray, "channels subjects subjects"]:
    """Compute inner products between centred subjects in float64, channel by channel."""
    subjects, channels, _ = blocks.shape
    grams = np.zeros((channels, subjects, subjects))
    for block in blocks:
        for channel in range(channels):
            centred = block[:, channel].astype(np.float64)
            centred -= centred.mean(0)
            grams[channel] += centred @ centred.T
    return grams


def combine_grams(
    grams: Float[np.ndarray, "channels subjects subjects"], scales: Float[np.ndarray, "channels"]
) -> Float[np.ndarray, "subjects subjects"]:
    """Compute inner products of features divided by the scales of their channels."""
    return np.tensordot(scales**-2.0, grams, 1)


class Axes(NamedTuple):
    """Principal axes as mixtures of subjects: sum_j vectors[j, k] x_j / sqrt(lengths[k]).

    `vectors` are unit eigenvectors of a centred Gram matrix and `lengths` its eigenvalues in
    descending order, without those that are rounding errors.
    """

    vectors: Float[np.ndarray, "subjects axes"]
    lengths: Float[np.ndarray, "axes"]


def compute_axes(gram: Float[np.ndarray, "subjects subjects"], most: int) -> Axes:
    """Compute the first axes of a centred Gram matrix, at most that many."""
    count = len(gram)
    first = min(max(count - most, 0), count - 1)
    lengths, vectors = eigh(gram, subset_by_index=(first, count - 1))
    lengths, vectors = lengths[::-1], vectors[:, ::-1]
    kept = lengths > RANK * max(lengths[0], np.finfo(float).tiny)
    # The sign of an eigenvector is arbitrary; without a rule, files would differ between runs.
    signs = np.sign(vectors[np.abs(vectors).argmax(0), np.arange(len(lengths))])
    return Axes((vectors * signs)[:, kept], lengths[kept])


def compute_components(
    blocks: FeatureBlocks,
    grams: Float[np.ndarray, "channels subjects subjects"],
    scales: Float[np.ndarray, "channels"],
    components: int | None = None,
) -> PrincipalComponents:
    """Compute the principal components of all subjects, in one more pass over them.

    Memory is that of the basis, 4 K C M bytes, and of a few blocks.

    Args:
        blocks: Features of the subjects.
        grams: Their inner products, from `compute_grams`.
        scales: What each channel is divided by.
        components: Number of components; None: all, up to `MAX_COMPONENTS`.

    Raises:
        InputError: If the subjects do not differ or span fewer components.

    Source:
        Section 5 and Equation 10 of Alotaibi & Smith 2017.
    """
    gram = combine_grams(grams, scales)
    divisor = max(len(gram) - 1, 1)
    total = float(np.trace(gram)) / divisor
    if total < SAME**2 * blocks.shape[1] * blocks.shape[2]:
        raise InputError(f"A model needs subjects that differ; got {len(gram)} that do not.")
    axes = compute_axes(gram, MAX_COMPONENTS if components is None else components)
    if components is not None and not 1 <= components <= len(axes.lengths):
        raise InputError(_describe_excess(components, gram))
    mean, basis = _compute_basis(blocks, axes, scales)
    return PrincipalComponents(mean, basis, axes.lengths / divisor, scales, total, len(gram))


def _describe_excess(asked: int, gram: Float[np.ndarray, "subjects subjects"]) -> str:
    rank = len(compute_axes(gram, len(gram)).lengths)
    return (
        f"{asked} components were asked for, and {len(gram)} subjects span {rank}; ask for 1 to "
        f"{rank}, or give more subjects."
    )


def _compute_basis(
    blocks: FeatureBlocks, axes: Axes, scales: Float[np.ndarray, "channels"]
) -> tuple[
    Float32[np.ndarray, "channels texels"], Float32[np.ndarray, "components channels texels"]
]:
    _, channels, texels = blocks.shape
    mean = np.empty((channels, texels), np.float32)
    basis = np.empty((len(axes.lengths), channels, texels), np.float32)
    mixing = (axes.vectors / np.sqrt(axes.lengths)).T
    start = 0
    for block in blocks:
        place = slice(start, start := start + block.shape[2])
        for channel, scale in enumerate(scales):
            values = block[:, channel].astype(np.float64)
            mean[channel, place] = centre = values.mean(0)
            basis[:, channel, place] = mixing @ ((values - centre) / scale)
    return mean, basis
