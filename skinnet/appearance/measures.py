"""Compactness, generalisation and specificity of appearance models (section 6 and Figure 8)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._mixtures import (
    Errors,
    leave_out,
    project_left_out,
    reconstruct_subjects,
    weigh_samples,
)
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._principal import combine_grams, compute_grams, sample_normal
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError

COUNTS = 25
"""Numbers of components at which a model is measured, at most."""

TEXELS = 2**16
"""Texels at which colours are compared where that needs decoding."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A measure by number of components: `values` [counts, cases], one case a subject or sample."""

    counts: Int[np.ndarray, "counts"]
    values: Float[np.ndarray, "counts cases"]
    unit: str

    @property
    def mean(self) -> Float[np.ndarray, "counts"]:
        """Mean over the cases."""
        return np.asarray(self.values.mean(1))


@dataclass(frozen=True, eq=False)
class Measures:
    """How good a model of appearance is, by number of components.

    `compactness` [K]: share of the variance of the model's own features that the first k components
    have (Figure 8a); features of different models have different units. `colour_compactness`:
    share of the subjects' variance in linear RGB that k components reproduce, which is the same
    question in one unit. `generalisation`: RMS error of each subject, reconstructed by a model of
    the others (Figure 8b). `specificity`: distance of each random face from the nearest subject,
    which the paper could not measure. Both are RMS over the mask in linear RGB. For a joint model
    `shape_generalisation` and `shape_specificity` are the same in mm, RMS over the vertices.
    """

    name: str
    compactness: Float[np.ndarray, "components"]
    colour_compactness: Curve
    generalisation: Curve
    specificity: Curve
    shape_generalisation: Curve | None = None
    shape_specificity: Curve | None = None

    def summary(self) -> dict[str, Any]:
        """Numbers that JSON can hold: each measure's mean by number of components."""
        curves = {name: curve for name, curve in vars(self).items() if isinstance(curve, Curve)}
        means = {
            name: dict(zip(curve.counts.tolist(), curve.mean.tolist(), strict=True))
            for name, curve in curves.items()
        }
        shares = dict(enumerate(self.compactness.tolist(), 1))
        return {"name": self.name, "compactness": shares} | means


def measure(
    model: AppearanceModel,
    stack: SubjectStack,
    counts: Int[np.ndarray, "counts"] | None = None,
    samples: int = 100,
    seed: int = 0,
    texels: int | None = TEXELS,
    name: str | None = None,
) -> Measures:
    """The measures of a hybrid or linear model on the stack that it was fitted to.

    No model is fitted again: those without one subject follow from inner products, which are
    gathered in one pass. Mask, scales and the filling of unknown texels are the whole model's.
    Random faces with k components are the first k of the same draws. `counts` are by default
    `default_counts`. A model whose features are not RGB is compared at `texels` of the mask (None:
    all). Raises `InputError` for fewer than three subjects or counts that cannot be had.
    """
    grams = compute_grams(model.read_blocks(stack, model.mask))
    gram = combine_grams(grams, model.statistics.scales)
    counts = check_counts(counts, len(model.statistics.variances), len(gram))
    normal = sample_normal(samples, len(model.statistics.variances), seed)
    left = [project_left_out(leave_out(gram, index), counts) for index in range(len(gram))]
    errors = model.colour_errors(stack, grams, texels)
    return Measures(
        name or type(model).__name__,
        np.cumsum(model.explained),
        colour_compactness(counts, reconstruct_subjects(gram, counts), errors),
        generalisation(counts, left, errors, "linear RGB"),
        specificity(counts, weigh_samples(gram, normal, counts), errors, "linear RGB"),
    )


def default_counts(most: int) -> Int[np.ndarray, "counts"]:
    """1 to `most`; if those are more than `COUNTS`, so many of them, spaced by ratio."""
    if most <= COUNTS:
        return np.arange(1, most + 1)
    return np.unique(np.rint(np.geomspace(1, most, COUNTS)).astype(np.int64))


def check_counts(
    counts: Int[np.ndarray, "counts"] | None, components: int, subjects: int
) -> Int[np.ndarray, "counts"]:
    """The numbers of components to measure at, as asked for or by default.

    Raises `InputError` if a model without one of the subjects cannot have them.
    """
    if subjects < 3:
        raise InputError(f"Leaving one subject out needs three or more; the stack has {subjects}.")
    most = min(components, subjects - 2)
    counts = default_counts(most) if counts is None else counts
    if not counts.size or counts.min() < 1 or counts.max() > most:
        raise InputError(
            f"Models of {subjects - 1} of the {subjects} subjects, with at most {components} "
            f"components, have 1 to {most}; got counts {counts.tolist()}."
        )
    return counts


def colour_compactness(
    counts: Int[np.ndarray, "counts"],
    changes: Float[np.ndarray, "subjects counts subjects"],
    errors: Errors,
) -> Curve:
    """Share of the subjects' variance in RGB that is reproduced, from changes of mean weights."""
    subjects = len(changes)
    mean = np.full((1, subjects), 1 / subjects)
    variance = (errors(mean) ** 2).sum()
    own = _own(1 / subjects + changes, errors) ** 2
    return Curve(counts, 1 - own.sum(1, keepdims=True) / variance, "share of variance")


def generalisation(
    counts: Int[np.ndarray, "counts"],
    changes: list[Float[np.ndarray, "counts others"]],
    errors: Errors,
    unit: str,
) -> Curve:
    """Errors of each subject when it is left out, from changes of the others' mean weights."""
    others = len(changes) - 1
    rows = [np.insert(1 / others + change, i, 0, axis=1) for i, change in enumerate(changes)]
    return Curve(counts, _own(np.stack(rows), errors), unit)


def specificity(
    counts: Int[np.ndarray, "counts"],
    changes: Float[np.ndarray, "samples counts subjects"],
    errors: Errors,
    unit: str,
) -> Curve:
    """Distance of random faces from the nearest subject, from changes of mean weights."""
    samples, _, subjects = changes.shape
    nearest = errors((1 / subjects + changes).reshape(-1, subjects)).min(1)
    return Curve(counts, nearest.reshape(samples, -1).T, unit)


def _own(
    weights: Float[np.ndarray, "subjects counts subjects"], errors: Errors
) -> Float[np.ndarray, "counts subjects"]:
    """Errors of the mixtures that stand for each subject, from that subject."""
    subjects = len(weights)
    found = errors(weights.reshape(-1, subjects)).reshape(weights.shape)
    return found[np.arange(subjects), :, np.arange(subjects)].T
