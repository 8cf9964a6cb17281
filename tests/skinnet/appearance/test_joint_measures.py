"""Measures of the joint model are those of models that are fitted again."""

from collections.abc import Callable

import numpy as np
import pytest

from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.joint import JointModel
from skinnet.appearance.joint_measures import measure_joint
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError
from skinnet.shape.model import ShapeModel

Without = Callable[[int], SubjectStack]


def rms(albedo: np.ndarray, other: np.ndarray, mask: np.ndarray) -> float:
    return float(np.sqrt(((albedo - other)[mask] ** 2).mean()))


def albedos(stack: SubjectStack) -> list[np.ndarray]:
    return [stack.texture(i).albedo(stack.colour) for i in range(len(stack.names))]


@pytest.fixture(scope="module")
def shape() -> ShapeModel:
    rng = np.random.default_rng(1)
    return ShapeModel(
        rng.standard_normal((9, 3)),
        rng.standard_normal((4, 9, 3)),
        np.array([9.0, 4.0, 1.0, 0.5]),
        np.zeros((1, 3), int),
        millimetres=10.0,
    )


@pytest.fixture(scope="module")
def alphas(shape: ShapeModel) -> np.ndarray:
    rng = np.random.default_rng(2)
    return 0.3 + rng.standard_normal((7, 4)) * np.sqrt(shape.variances)


def joint_of(
    model: AppearanceModel, stack: SubjectStack, alphas: np.ndarray, shape: ShapeModel
) -> JointModel:
    return JointModel.fit(alphas, model.coefficients(stack), np.sqrt(shape.variances))


@pytest.mark.parametrize("components", [None, 3])
def test_the_joint_model_too_is_measured_as_if_refitted(
    components: int | None,
    stack: SubjectStack,
    without: Without,
    shape: ShapeModel,
    alphas: np.ndarray,
) -> None:
    model = HybridModel.fit(stack, components)
    joint = joint_of(model, stack, alphas, shape)
    found = measure_joint(joint, model, stack, shape, alphas, samples=4, seed=5, texels=None)
    assert np.allclose(found.compactness, np.cumsum(joint.explained))
    index, others, face = 2, without(2), stack.texture(2)
    refit = HybridModel.fit(others, components, model.mask, model.statistics.scales)
    for row, count in enumerate(found.generalisation.counts):
        both = JointModel.fit(
            np.delete(alphas, index, 0),
            refit.coefficients(others),
            joint.deviations,
            joint.weight,
            int(count),
        )
        alpha, beta = both.reconstruct(both.project(alphas[index], refit.project(face)))
        error = rms(refit.reconstruct(beta), face.albedo(stack.colour), model.mask)
        assert found.generalisation.values[row, index] == pytest.approx(error, rel=2e-3)
        assert found.shape_generalisation is not None
        moved = 10 * (shape.reconstruct(alpha) - shape.reconstruct(alphas[index]))
        error = float(np.sqrt((moved**2).sum(1).mean()))
        assert found.shape_generalisation.values[row, index] == pytest.approx(error, rel=2e-3)


def test_joint_specificity_is_that_of_decoded_samples(
    stack: SubjectStack, shape: ShapeModel, alphas: np.ndarray
) -> None:
    model = HybridModel.fit(stack, 4)
    joint = joint_of(model, stack, alphas, shape)
    found = measure_joint(joint, model, stack, shape, alphas, samples=3, seed=5, texels=None)
    assert found.shape_specificity is not None and found.shape_specificity.unit == "mm"
    for row, gamma in enumerate(joint.sample(3, seed=5)):
        for place, count in enumerate(found.specificity.counts):
            cut = np.where(np.arange(len(gamma)) < count, gamma, 0)
            alpha, beta = joint.reconstruct(cut)
            face, surface = model.reconstruct(beta), shape.reconstruct(alpha)
            nearest = min(rms(face, other, model.mask) for other in albedos(stack))
            assert found.specificity.values[place, row] == pytest.approx(nearest, rel=2e-3)
            moved = [10 * (surface - shape.reconstruct(other)) for other in alphas]
            nearest = min(float(np.sqrt((step**2).sum(1).mean())) for step in moved)
            assert found.shape_specificity.values[place, row] == pytest.approx(nearest, rel=2e-3)


def test_shapes_that_do_not_match_are_refused(
    stack: SubjectStack, shape: ShapeModel, alphas: np.ndarray
) -> None:
    model = HybridModel.fit(stack)
    joint = joint_of(model, stack, alphas, shape)
    with pytest.raises(InputError, match="There are 6 shapes and 7 subjects"):
        measure_joint(joint, model, stack, shape, alphas[:6])
    with pytest.raises(InputError, match="has 4 shape coefficients, the shapes have 3"):
        measure_joint(joint, model, stack, shape, alphas[:, :3])
