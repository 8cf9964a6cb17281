"""Curves of compactness, generalisation and specificity by number of components."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._mixtures import MixtureErrors
from skinnet.errors import InputError

COUNTS = 25
"""Largest number of points on a curve."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A measure at each number of components, for each subject or sample, with its unit."""

    counts: Int[np.ndarray, "counts"]
    values: Float[np.ndarray, "counts cases"]
    unit: str

    @property
    def mean(self) -> Float[np.ndarray, "counts"]:
        """Mean over subjects or samples."""
        return np.asarray(self.values.mean(1))


def space_counts(most: int) -> Int[np.ndarray, "counts"]:
    """Choose all numbers from 1 to `most`, or about `COUNTS` of them in geometric steps."""
    if most <= COUNTS:
        return np.arange(1, most + 1)
    return np.unique(np.rint(np.geomspace(1, most, COUNTS)).astype(np.int64))


def choose_counts(
    counts: Int[np.ndarray, "counts"] | None, components: int, subjects: int
) -> Int[np.ndarray, "counts"]:
    """Choose the numbers of components to measure at, or check those given.

    Raises:
        InputError: If a model without one of the subjects cannot have so many components.
    """
    if subjects < 3:
        raise InputError(f"Leaving one subject out needs three or more; the stack has {subjects}.")
    most = min(components, subjects - 2)
    counts = space_counts(most) if counts is None else counts
    if not counts.size or counts.min() < 1 or counts.max() > most:
        raise InputError(
            f"Models of {subjects - 1} of the {subjects} subjects, with at most {components} "
            f"components, are measured at 1 to {most}; got counts {counts.tolist()}."
        )
    return counts


def compute_colour_compactness(
    counts: Int[np.ndarray, "counts"],
    changes: Float[np.ndarray, "subjects counts subjects"],
    errors: MixtureErrors,
) -> Curve:
    """Compute the share of the subjects' variance in linear RGB that is reproduced.

    `changes` are differences of the mixture's weights from those of the mean.
    """
    subjects = len(changes)
    mean = np.full((1, subjects), 1 / subjects)
    variance = (errors(mean) ** 2).sum()
    own = _select_own(1 / subjects + changes, errors) ** 2
    return Curve(counts, 1 - own.sum(1, keepdims=True) / variance, "share of variance")


def compute_generalisation(
    counts: Int[np.ndarray, "counts"],
    changes: list[Float[np.ndarray, "counts others"]],
    errors: MixtureErrors,
    unit: str,
) -> Curve:
    """Compute the error of each subject from its reconstruction by a model of the others.

    Source:
        Section 6 and Figure 8(b) of Alotaibi & Smith 2017.
    """
    others = len(changes) - 1
    rows = [np.insert(1 / others + change, i, 0, axis=1) for i, change in enumerate(changes)]
    return Curve(counts, _select_own(np.stack(rows), errors), unit)


def compute_specificity(
    counts: Int[np.ndarray, "counts"],
    changes: Float[np.ndarray, "samples counts subjects"],
    errors: MixtureErrors,
    unit: str,
) -> Curve:
    """Compute the distance of each random face from the nearest subject.

    Source:
        Section 6 of Alotaibi & Smith 2017 names it; its 25 faces were too few to measure it.
    """
    samples, _, subjects = changes.shape
    nearest = errors((1 / subjects + changes).reshape(-1, subjects)).min(1)
    return Curve(counts, nearest.reshape(samples, -1).T, unit)


def _select_own(
    weights: Float[np.ndarray, "subjects counts subjects"], errors: MixtureErrors
) -> Float[np.ndarray, "counts subjects"]:
    """Compute the errors of each subject's own mixtures from that subject."""
    subjects = len(weights)
    found = errors(weights.reshape(-1, subjects)).reshape(weights.shape)
    return found[np.arange(subjects), :, np.arange(subjects)].T
