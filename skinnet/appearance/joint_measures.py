"""The measures of a joint model, in linear RGB and in millimetres."""

from functools import partial

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._mixtures import (
    LeftOut,
    errors,
    leave_out,
    project_left_out,
    reconstruct_subjects,
    weigh_samples,
)
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._principal import (
    Axes,
    combine_grams,
    compute_axes,
    compute_grams,
    sample_normal,
)
from skinnet.appearance.joint import JointModel
from skinnet.appearance.measures import (
    TEXELS,
    Measures,
    check_counts,
    colour_compactness,
    generalisation,
    specificity,
)
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError
from skinnet.shape.model import ShapeModel


def measure_joint(
    joint: JointModel,
    appearance: AppearanceModel,
    stack: SubjectStack,
    shape: ShapeModel,
    alphas: Float[np.ndarray, "shapes modes"],
    counts: Int[np.ndarray, "counts"] | None = None,
    samples: int = 100,
    seed: int = 0,
    texels: int | None = TEXELS,
    name: str = "JointModel",
) -> Measures:
    """The measures of a joint model on the people that it was fitted to, in linear RGB and in mm.

    Each model of the others has an appearance model of the others inside, with as many components
    as `appearance`. Everything else is as for `measure`.
    """
    grams = compute_grams(appearance.read_blocks(stack, appearance.mask))
    gram = combine_grams(grams, appearance.statistics.scales)
    _check(joint, shape, alphas, len(gram))
    surface = _centred_gram(joint.weight * alphas / joint.deviations)
    counts = check_counts(counts, len(joint.statistics.variances), len(gram))
    kept = len(appearance.statistics.variances)
    axes = compute_axes(gram, kept)
    whole = surface + _truncated(axes)
    drawn = weigh_samples(
        whole, sample_normal(samples, len(joint.statistics.variances), seed), counts
    )
    without = [_joint_left_out(gram, surface, index, kept) for index in range(len(gram))]
    left = [project_left_out(products, counts) for products, _ in without]
    left_colour = [_followed(change, own) for change, (_, own) in zip(left, without, strict=True)]
    colour = appearance.colour_errors(stack, grams, texels)
    millimetres = partial(errors, _centred_gram(_moved(shape, alphas)))
    return Measures(
        name,
        np.cumsum(joint.explained),
        colour_compactness(counts, _followed(reconstruct_subjects(whole, counts), axes), colour),
        generalisation(counts, left_colour, colour, "linear RGB"),
        specificity(counts, _followed(drawn, axes), colour, "linear RGB"),
        generalisation(counts, left, millimetres, "mm"),
        specificity(counts, drawn, millimetres, "mm"),
    )


def _check(
    joint: JointModel,
    shape: ShapeModel,
    alphas: Float[np.ndarray, "shapes modes"],
    subjects: int,
) -> None:
    if len(alphas) != subjects:
        raise InputError(f"There are {len(alphas)} shapes and {subjects} subjects in the stack.")
    modes = len(joint.deviations)
    if alphas.shape[1] != modes or modes > len(shape.basis):
        raise InputError(
            f"The joint model has {modes} shape coefficients, the shapes have {alphas.shape[1]}, "
            f"and {shape.name} has {len(shape.basis)} modes; give those that it was fitted with."
        )


def _joint_left_out(
    gram: Float[np.ndarray, "subjects subjects"],
    shape_gram: Float[np.ndarray, "subjects subjects"],
    index: int,
    kept: int,
) -> tuple[LeftOut, Axes]:
    """Joint inner products without one subject, and the axes of the others' appearance model."""
    appearance, surface = leave_out(gram, index), leave_out(shape_gram, index)
    axes = compute_axes(appearance.gram, kept)
    cross = surface.cross + _followed(appearance.cross, axes)
    return LeftOut(surface.gram + _truncated(axes), cross), axes


def _truncated(axes: Axes) -> Float[np.ndarray, "subjects subjects"]:
    """The Gram matrix that is left of appearance in a model with these axes."""
    return np.asarray(axes.vectors * axes.lengths @ axes.vectors.T)


def _followed(
    changes: Float[np.ndarray, "*batch subjects"], axes: Axes
) -> Float[np.ndarray, "*batch subjects"]:
    """Changes of weights as a model with these axes can follow them."""
    return np.asarray(changes @ axes.vectors @ axes.vectors.T)


def _centred_gram(
    rows: Float[np.ndarray, "subjects values"],
) -> Float[np.ndarray, "subjects subjects"]:
    centred = rows - rows.mean(0)
    return np.asarray(centred @ centred.T)


def _moved(
    shape: ShapeModel, alphas: Float[np.ndarray, "subjects modes"]
) -> Float[np.ndarray, "subjects modes"]:
    """Alpha in coordinates whose distance is the RMS displacement of a vertex in mm."""
    basis = shape.basis[: alphas.shape[1]].reshape(alphas.shape[1], -1)
    lengths, directions = np.linalg.eigh(basis @ basis.T)
    scales = np.sqrt(np.maximum(lengths, 0) / len(shape.mean)) * shape.millimetres
    return np.asarray(alphas @ directions * scales)
