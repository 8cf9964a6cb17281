"""Compactness, generalisation and specificity of models (section 6 of Alotaibi & Smith 2017)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from skinnet.appearance._curves import (
    Curve,
    choose_counts,
    compute_colour_compactness,
    compute_generalisation,
    compute_specificity,
)
from skinnet.appearance._mixtures import (
    leave_out,
    project_left_out,
    reconstruct_subjects,
    weigh_samples,
)
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._principal import combine_grams, compute_grams, sample_normal
from skinnet.appearance.stack import SubjectStack

_TEXELS = 2**16
"""Texels at which colours are compared if features must be decoded."""


@dataclass(frozen=True, eq=False)
class Measures:
    """The quality of a model of appearance, by number of components.

    Args:
        name: Name of the model.
        compactness: Share of the variance of the model's own features that the first k components
            explain (Figure 8(a)). The features of different models have different units.
        colour_compactness: Share of the subjects' variance in linear RGB that k components
            reproduce, which compares models in one unit.
        generalisation: RMS error of each subject in linear RGB when it is reconstructed by a model
            of the others (Figure 8(b)).
        specificity: RMS distance in linear RGB of each random face from the nearest subject.
        shape_generalisation: For a joint model, the error of shape in mm, RMS over the vertices.
        shape_specificity: For a joint model, the distance of shape in mm, RMS over the vertices.

    Source:
        Section 6 and Figure 8 of Alotaibi & Smith 2017.
    """

    name: str
    compactness: Float[np.ndarray, "components"]
    colour_compactness: Curve
    generalisation: Curve
    specificity: Curve
    shape_generalisation: Curve | None = None
    shape_specificity: Curve | None = None

    def summary(self) -> dict[str, Any]:
        """Compute the mean of each measure by number of components, in JSON's types.

        Returns:
            The name, and for each measure a dictionary from number of components to mean.
        """
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
    texels: int | None = _TEXELS,
    name: str | None = None,
) -> Measures:
    """Measure a hybrid or linear model on the stack that it was fitted to.

    No model is fitted again. The models that leave one subject out follow from inner products
    between subjects, which take one pass over the stack. They keep the mask and the scales of the
    whole model. Random faces with fewer components are the same faces, truncated to these.

    Args:
        model: The model.
        stack: The subjects that it was fitted to.
        counts: Numbers of components to measure at; None: all, or 25 in geometric steps.
        samples: Number of random faces for specificity.
        seed: Seed of the random faces.
        texels: Number of texels at which the colours of a hybrid model are compared; None: all.
        name: Name of the model in the result; None: that of its class.

    Returns:
        The measures at each number of components.

    Raises:
        InputError: If there are fewer than three subjects, or models that leave one out cannot have
            so many components.

    Source:
        Section 6 and Figure 8 of Alotaibi & Smith 2017.
    """
    grams = compute_grams(model.read_blocks(stack, model.mask))
    gram = combine_grams(grams, model.statistics.scales)
    counts = choose_counts(counts, len(model.statistics.variances), len(gram))
    normal = sample_normal(samples, len(model.statistics.variances), seed)
    left = [project_left_out(leave_out(gram, index), counts) for index in range(len(gram))]
    errors = model.colour_errors(stack, grams, texels)
    return Measures(
        name or type(model).__name__,
        np.cumsum(model.explained),
        compute_colour_compactness(counts, reconstruct_subjects(gram, counts), errors),
        compute_generalisation(counts, left, errors, "linear RGB"),
        compute_specificity(counts, weigh_samples(gram, normal, counts), errors, "linear RGB"),
    )
