"""Pose, scale and shape of a linear model by separable nonlinear least squares (VarPro)."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.transform import Rotation

from skinnet.errors import InputError
from skinnet.shape._moments import Moments
from skinnet.shape.similarity import Similarity

ITERATIONS = 60
TOLERANCE = 1e-12
"""A fit has converged when the predicted decrease is less than this share of the objective."""

# The identity, and the generators of rotations about x, y and z. With T one of them, the rotated
# data are z = T R^T x, whose coefficients for the columns e_j x_k (j is slower) are T R^T.
_ROTATIONS = np.stack([np.eye(3), *np.cross(np.eye(3)[:, None], -np.eye(3)).swapaxes(1, 2)])


class Evaluation(NamedTuple):
    """The objective at one pose, with the linear parameters at their best.

    `gradient` [4] and `curvature` [4, 4] (J^T J of Gauss-Newton) are derivatives by a rotation of
    the model about its own axes in radians and by the natural logarithm of the scale.
    """

    value: float
    gradient: Float[np.ndarray, "4"]
    curvature: Float[np.ndarray, "4 4"]
    alpha: Float[np.ndarray, "modes"]
    pose: Similarity


@dataclass(frozen=True)
class SeparableObjective:
    """eps(r, s) = min over alpha, t of sum_i |x_i - s R(r) (Q_i alpha + mean_i) - t|^2_W + prior.

    This is Equation 8 of Alotaibi & Smith 2017 with two corrections. Equation 5 prints
    s (R Q_i alpha + mean_i), where the mean must be rotated too. Equation 6 needs
    y = x - s (I (x) R) mean; the printed sign is reversed. The residuals are linear in alpha and t,
    which Equation 7 eliminates (variable projection, Golub & Pereyra 1973).

    The prior is `weight` * sum_k alpha_k^2 / variances_k (a MAP estimate), with `weight` in the
    data's squared unit; 0 is the paper's form. An evaluation costs O(S^2), or O(S^3) with a prior,
    and does not depend on the number of vertices: with 53,490 vertices and 199 modes it takes about
    a millisecond, where solving Equation 6 for A takes seconds (`python -m benchmarks.fit`).
    """

    moments: Moments
    variances: Float[np.ndarray, "modes"]
    weight: float = 0.0

    def __call__(self, rotation: Float[np.ndarray, "3 3"], scale: float) -> Evaluation:
        """Compute Equation 8, its gradient and its curvature at a pose."""
        modes = len(self.variances)
        # Without a prior the elimination does not depend on the pose.
        linear, inner = self._eliminate(scale) if self.weight > 0 else self._eliminated
        combination = np.zeros((10, 5))
        combination[:9, :4] = (_ROTATIONS @ rotation.T).reshape(4, 9).T
        combination[9, 4] = scale
        y = combination[:, 0] - combination[:, 4]
        p = linear @ y
        steps = np.column_stack([combination[:, 1:4], -combination[:, 4]])
        value = y @ inner @ y
        gradient = 2 * steps.T @ inner @ y
        curvature = steps.T @ inner @ steps
        a = p[:modes]
        if self.weight > 0:
            # The linear parameters are scale * alpha, so the prior's rows depend on the scale.
            prior = self.weight / (scale**2 * self.variances)
            prior_gradient = prior * a
            right = np.concatenate([prior_gradient, np.zeros(3)])
            solved = self._solve_normal_equations(scale, right)[:modes]
            gradient[3] -= 2 * a @ prior_gradient
            coupling = -prior_gradient @ linear[:modes] @ steps
            curvature[3] += coupling
            curvature[:, 3] += coupling
            curvature[3, 3] += prior_gradient @ a - prior_gradient @ solved
        translation = rotation @ p[modes:] + self.moments.origin
        pose = Similarity(rotation, scale, translation)
        return Evaluation(float(value), gradient, curvature, a / scale, pose)

    @cached_property
    def _eliminated(self) -> tuple[Float[np.ndarray, "columns 10"], Float[np.ndarray, "10 10"]]:
        return self._eliminate(1.0)

    def _eliminate(
        self, scale: float
    ) -> tuple[Float[np.ndarray, "columns 10"], Float[np.ndarray, "10 10"]]:
        """Compute A^+ times each data column (Equation 7), and inner products of the residuals."""
        linear = self._solve_normal_equations(scale, self.moments.cross)
        return linear, self.moments.data - self.moments.cross.T @ linear

    def _solve_normal_equations(
        self, scale: float, right: Float[np.ndarray, "columns *right"]
    ) -> Float[np.ndarray, "columns *right"]:
        design = self.moments.design.copy()
        modes = np.arange(len(self.variances))
        design[modes, modes] += self.weight / (scale**2 * self.variances)
        try:
            return np.asarray(cho_solve(cho_factor(design), right))
        except np.linalg.LinAlgError as error:
            raise InputError(
                f"{len(self.variances)} modes cannot be distinguished by these correspondences; "
                "use fewer modes or a MAP weight above 0."
            ) from error


class Solution(NamedTuple):
    """The result of a separable fit, and the objective after each accepted step."""

    pose: Similarity
    alpha: Float[np.ndarray, "modes"]
    value: float
    history: list[float]
    converged: bool


def minimise(
    objective: SeparableObjective,
    start: Similarity,
    iterations: int = ITERATIONS,
    tolerance: float = TOLERANCE,
) -> Solution:
    """Minimise Equation 8 of Alotaibi & Smith 2017 from `start` by damped Gauss-Newton steps.

    The damping is Levenberg-Marquardt's. The iteration stops when a step is predicted to lower the
    objective by less than `tolerance` times its value, or after `iterations`.
    """
    best = objective(start.rotation, start.scale)
    history, damping = [best.value], 1e-6
    for _ in range(iterations):
        scaled = best.curvature + damping * np.diag(np.diag(best.curvature))
        step = np.linalg.lstsq(scaled, -best.gradient / 2, rcond=None)[0]
        predicted = -(best.gradient @ step) / 2
        if predicted <= tolerance * best.value:
            return Solution(best.pose, best.alpha, best.value, history, True)
        rotation = best.pose.rotation @ Rotation.from_rotvec(step[:3]).as_matrix()
        candidate = objective(rotation, best.pose.scale * float(np.exp(np.clip(step[3], -1, 1))))
        if candidate.value < best.value:
            best, damping = candidate, max(damping / 10, 1e-12)
            history.append(best.value)
        else:
            damping *= 10
            if damping > 1e12:
                return Solution(best.pose, best.alpha, best.value, history, True)
    return Solution(best.pose, best.alpha, best.value, history, False)
