"""The measures of a joint model, in linear RGB and in millimetres."""

from functools import partial

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._curves import (
    choose_counts,
    compute_colour_compactness,
    compute_generalisation,
    compute_specificity,
)
from skinnet.appearance._mixtures import (
    LeftOut,
    compute_errors,
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
from skinnet.appearance.measures import _TEXELS, Measures
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
    texels: int | None = _TEXELS,
    name: str = "JointModel",
) -> Measures:
    """Measure a joint model on the people that it was fitted to, in linear RGB and in mm.

    Each model that leaves one person out contains an appearance model that leaves the same person
    out and has as many components as `appearance`.

    Args:
        joint: The joint model.
        appearance: The appearance model whose coefficients it was fitted to.
        stack: The people that both were fitted to.
        shape: The shape model of the people's shapes.
        alphas: Shape coefficients of the people.
        counts: Numbers of components to measure at; None: all, or 25 in geometric steps.
        samples: Number of random faces for specificity.
        seed: Seed of the random faces.
        texels: Number of texels at which the colours of a hybrid model are compared; None: all.
        name: Name of the model in the result.

    Returns:
        The measures at each number of components, those of shape in mm.

    Raises:
        InputError: If the shapes, the people and the models do not match, there are fewer than
            three people, or models that leave one out cannot have so many components.
    """
    grams = compute_grams(appearance.read_blocks(stack, appearance.mask))
    gram = combine_grams(grams, appearance.statistics.scales)
    _check(joint, shape, alphas, len(gram))
    surface = _compute_gram(joint.weight * alphas / joint.deviations)
    counts = choose_counts(counts, len(joint.statistics.variances), len(gram))
    kept = len(appearance.statistics.variances)
    axes = compute_axes(gram, kept)
    whole = surface + _truncate(axes)
    sampled = weigh_samples(
        whole, sample_normal(samples, len(joint.statistics.variances), seed), counts
    )
    without = [_leave_out_jointly(gram, surface, index, kept) for index in range(len(gram))]
    left = [project_left_out(products, counts) for products, _ in without]
    left_colour = [
        _project_weights(change, own) for change, (_, own) in zip(left, without, strict=True)
    ]
    colour = appearance.colour_errors(stack, grams, texels)
    millimetres = partial(compute_errors, _compute_gram(_scale_to_mm(shape, alphas)))
    return Measures(
        name,
        np.cumsum(joint.explained),
        compute_colour_compactness(
            counts, _project_weights(reconstruct_subjects(whole, counts), axes), colour
        ),
        compute_generalisation(counts, left_colour, colour, "linear RGB"),
        compute_specificity(counts, _project_weights(sampled, axes), colour, "linear RGB"),
        compute_generalisation(counts, left, millimetres, "mm"),
        compute_specificity(counts, sampled, millimetres, "mm"),
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


def _leave_out_jointly(
    gram: Float[np.ndarray, "subjects subjects"],
    shape_gram: Float[np.ndarray, "subjects subjects"],
    index: int,
    kept: int,
) -> tuple[LeftOut, Axes]:
    """Compute the inner products without one person, and the axes of that appearance model."""
    appearance, surface = leave_out(gram, index), leave_out(shape_gram, index)
    axes = compute_axes(appearance.gram, kept)
    cross = surface.cross + _project_weights(appearance.cross, axes)
    return LeftOut(surface.gram + _truncate(axes), cross), axes


def _truncate(axes: Axes) -> Float[np.ndarray, "subjects subjects"]:
    """Compute the Gram matrix of appearance, restricted to the axes of a model."""
    return np.asarray(axes.vectors * axes.lengths @ axes.vectors.T)


def _project_weights(
    changes: Float[np.ndarray, "*batch subjects"], axes: Axes
) -> Float[np.ndarray, "*batch subjects"]:
    """Project changes of weights on the axes of a model."""
    return np.asarray(changes @ axes.vectors @ axes.vectors.T)


def _compute_gram(
    rows: Float[np.ndarray, "subjects values"],
) -> Float[np.ndarray, "subjects subjects"]:
    centred = rows - rows.mean(0)
    return np.asarray(centred @ centred.T)


def _scale_to_mm(
    shape: ShapeModel, alphas: Float[np.ndarray, "subjects modes"]
) -> Float[np.ndarray, "subjects modes"]:
    """Transform alpha so that distances are RMS displacements of the vertices in mm."""
    basis = shape.basis[: alphas.shape[1]].reshape(alphas.shape[1], -1)
    lengths, directions = np.linalg.eigh(basis @ basis.T)
    scales = np.sqrt(np.maximum(lengths, 0) / len(shape.mean)) * shape.millimetres
    return np.asarray(alphas @ directions * scales)
