"""The separable fit beside scipy's solver of the whole objective, and its derivatives."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from skinnet.errors import InputError
from skinnet.shape._moments import compute_moments
from skinnet.shape._separable import SeparableObjective, minimise
from skinnet.shape.similarity import Similarity

MODES, VERTICES = 6, 40
POSE, SCALE = Rotation.from_rotvec([0.2, -0.1, 0.3]).as_matrix(), 1.5


class Problem:
    """Noisy correspondences of a small random model, and the paper's residuals one by one."""

    def __init__(self, weight: float, sliding: float | None) -> None:
        rng = np.random.default_rng(3)
        self.basis = rng.normal(size=(MODES, VERTICES, 3))
        self.mean = 10 * rng.normal(size=(VERTICES, 3))
        self.weights = rng.random(VERTICES)
        self.weights[:4] = 0
        self.variances = 0.5 + rng.random(MODES)
        self.weight = weight
        shape = self.mean + np.tensordot(rng.normal(size=MODES), self.basis, 1)
        rotation = Rotation.from_rotvec([0.3, -0.2, 0.4]).as_matrix()
        self.points = 1.7 * shape @ rotation.T + [300, -20, 5]
        self.points += 0.3 * rng.normal(size=(VERTICES, 3))
        self.metric = np.tile(np.eye(3), (VERTICES, 1, 1))
        self.normals = None
        if sliding is not None:
            self.normals = rng.normal(size=(VERTICES, 3))
            self.normals /= np.linalg.norm(self.normals, axis=1, keepdims=True)
            across = self.normals[:, :, None] * self.normals[:, None]
            self.metric = (1 - sliding) * across + sliding * np.eye(3)
        moments = compute_moments(
            self.basis, self.mean, self.points, self.weights, self.normals, sliding or 0.0
        )
        self.separable = SeparableObjective(moments, self.variances, weight)

    def residuals(self, numbers: np.ndarray) -> np.ndarray:
        """Of rotation vector, log scale, translation and alpha, in the model's rotated frame."""
        rotation = Rotation.from_rotvec(numbers[:3]).as_matrix()
        shape = self.mean + np.tensordot(numbers[7:], self.basis, 1)
        moved = np.exp(numbers[3]) * shape @ rotation.T + numbers[4:7]
        root = np.linalg.cholesky(self.metric + 1e-300 * np.eye(3))
        error = np.einsum("vkj,vk->vj", root, (self.points - moved) @ rotation)
        prior = np.sqrt(self.weight / self.variances) * numbers[7:]
        return np.concatenate([(np.sqrt(self.weights)[:, None] * error).ravel(), prior])

    def project(self, step: np.ndarray) -> np.ndarray:
        """Residuals at a pose that far from POSE and SCALE, alpha and t at their best."""
        rotation = POSE @ Rotation.from_rotvec(step[:3]).as_matrix()
        found = self.separable(rotation, SCALE * np.exp(step[3]))
        vector, pose = Rotation.from_matrix(rotation).as_rotvec(), found.pose
        numbers = [vector, [np.log(pose.scale)], pose.translation, found.alpha]
        return self.residuals(np.concatenate(numbers))

    def jacobian(self, step: float = 1e-5) -> np.ndarray:
        moves = step * np.eye(4)
        columns = [(self.project(move) - self.project(-move)) / 2 / step for move in moves]
        return np.stack(columns, 1)


PROBLEMS = pytest.mark.parametrize("sliding", [None, 0.1])
PRIORS = pytest.mark.parametrize("weight", [0.0, 3.0])


@PROBLEMS
@PRIORS
def test_equals_a_plain_solver_of_the_whole_objective(weight: float, sliding: float | None) -> None:
    problem = Problem(weight, sliding)
    initial = np.zeros(7 + MODES)
    initial[4:7] = problem.points.mean(0)
    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
    plain = least_squares(problem.residuals, initial, **tight)
    start = Similarity(np.eye(3), 1.0, np.zeros(3))
    ours = minimise(problem.separable, start)
    assert ours.converged
    assert ours.value == pytest.approx(2 * plain.cost, rel=1e-8)
    np.testing.assert_allclose(ours.alpha, plain.x[7:], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(ours.pose.translation, plain.x[4:7], rtol=1e-6)
    np.testing.assert_allclose(ours.pose.scale, np.exp(plain.x[3]), rtol=1e-6)
    rotation = Rotation.from_rotvec(plain.x[:3]).as_matrix()
    np.testing.assert_allclose(ours.pose.rotation, rotation, atol=1e-6)


@PROBLEMS
@PRIORS
def test_value_and_gradient_are_those_of_the_residuals(
    weight: float, sliding: float | None
) -> None:
    problem = Problem(weight, sliding)
    found = problem.separable(POSE, SCALE)
    residuals, jacobian = problem.project(np.zeros(4)), problem.jacobian()
    assert found.value == pytest.approx(residuals @ residuals, rel=1e-10)
    np.testing.assert_allclose(found.gradient, 2 * jacobian.T @ residuals, rtol=1e-5)


@PROBLEMS
def test_curvature_is_that_of_the_jacobian_by_differences(sliding: float | None) -> None:
    problem = Problem(0.0, sliding)
    jacobian = problem.jacobian()
    found = problem.separable(POSE, SCALE).curvature
    np.testing.assert_allclose(found, jacobian.T @ jacobian, rtol=1e-5, atol=1e-4)


def test_curvature_with_a_prior_is_positive_and_near_the_jacobian_near_the_solution() -> None:
    problem = Problem(3.0, None)
    eigenvalues = np.linalg.eigvalsh(problem.separable(POSE, SCALE).curvature)
    assert eigenvalues.min() > 0


def test_history_never_rises() -> None:
    problem = Problem(1.0, None)
    start = Similarity(Rotation.from_rotvec([0, 1.5, 0]).as_matrix(), 4.0, np.zeros(3))
    history = minimise(problem.separable, start).history
    assert np.all(np.diff(history) < 0)
    assert len(history) > 2


def test_a_vertex_without_weight_changes_nothing() -> None:
    problem = Problem(0.0, None)
    points = problem.points.copy()
    points[:4] += 1e4
    moved = compute_moments(problem.basis, problem.mean, points, problem.weights)
    again = SeparableObjective(moved, problem.variances)(POSE, SCALE)
    assert again.value == pytest.approx(problem.separable(POSE, SCALE).value, rel=1e-9)


def test_chunks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = Problem(0.0, None)
    monkeypatch.setattr("skinnet.shape._moments.CHUNK", 7)
    parts = compute_moments(problem.basis, problem.mean, problem.points, problem.weights)
    np.testing.assert_allclose(parts.design, problem.separable.moments.design, rtol=1e-12)
    np.testing.assert_allclose(parts.cross, problem.separable.moments.cross, rtol=1e-9, atol=1e-9)


def test_modes_that_cannot_be_distinguished_are_refused_in_words() -> None:
    problem = Problem(0.0, None)
    basis = np.concatenate([problem.basis, problem.basis[:1]])
    moments = compute_moments(basis, problem.mean, problem.points, problem.weights)
    repeated = SeparableObjective(moments, np.ones(MODES + 1))
    with pytest.raises(InputError, match="fewer modes or a MAP weight"):
        repeated(POSE, SCALE)
