"""Pose, scale and shape of a linear model by separable nonlinear least squares."""

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
"""A fit has converged when a step lowers the objective by less than this share of it."""

# z, and its derivatives by a turn about x, y and z, from the outer product e_j x_k: j major.
_TURNS = np.stack([np.eye(3), *np.cross(np.eye(3)[:, None], -np.eye(3)).swapaxes(1, 2)])


class Evaluation(NamedTuple):
    """The objective at one pose, with the linear parameters at their best.

    `gradient` [4] and `curvature` [4, 4] (J^T J of Gauss-Newton) are by a turn of the model about
    its own axes in radians and by the natural logarithm of the scale.
    """

    value: float
    gradient: Float[np.ndarray, "4"]
    curvature: Float[np.ndarray, "4 4"]
    alpha: Float[np.ndarray, "modes"]
    pose: Similarity


@dataclass(frozen=True)
class Separable:
    """eps(r, s) = min over alpha, t of sum_i |x_i - s R(r) (Q_i alpha + mean_i) - t|^2_W + prior.

    Equation 8 of Alotaibi & Smith (2017) with the mean rotated too and the sign of y mended: the
    residuals are linear in alpha and t, and these are eliminated (variable projection). An
    evaluation costs O(S^2), or O(S^3) with a prior, and does not depend on the number of vertices.

    The prior is `weight` * sum_k alpha_k^2 / variances_k, with `weight` in the data's squared
    unit; 0 is the paper's form.
    """

    moments: Moments
    variances: Float[np.ndarray, "modes"]
    weight: float = 0.0

    def __call__(self, rotation: Float[np.ndarray, "3 3"], scale: float) -> Evaluation:
        """Value, gradient and curvature at a pose."""
        modes = len(self.variances)
        linear, inner = self._reduced(scale)
        turn = np.zeros((10, 5))
        # z_a = sum_l T_a[j, l] R[k, l] x_k, so the weight of column e_j x_k is (T_a R^T)[j, k].
        turn[:9, :4] = (_TURNS @ rotation.T).reshape(4, 9).T
        turn[9, 4] = scale
        y = turn[:, 0] - turn[:, 4]
        p = linear @ y
        steps = np.column_stack([turn[:, 1:4], -turn[:, 4]])
        value = y @ inner @ y
        gradient = 2 * steps.T @ inner @ y
        curvature = steps.T @ inner @ steps
        a = p[:modes]
        if self.weight > 0:
            # A longer scale needs less alpha for the same shape: the prior's rows move with it.
            prior = self.weight / (scale**2 * self.variances)
            pull = prior * a
            solved = self._solve(scale, np.concatenate([pull, np.zeros(3)]))[:modes]
            gradient[3] -= 2 * a @ pull
            coupling = -pull @ linear[:modes] @ steps
            curvature[3] += coupling
            curvature[:, 3] += coupling
            curvature[3, 3] += pull @ a - pull @ solved
        translation = rotation @ p[modes:] + self.moments.origin
        pose = Similarity(rotation, scale, translation)
        return Evaluation(float(value), gradient, curvature, a / scale, pose)

    @cached_property
    def _free(self) -> tuple[Float[np.ndarray, "columns 10"], Float[np.ndarray, "10 10"]]:
        return self._eliminated(1.0)

    def _reduced(
        self, scale: float
    ) -> tuple[Float[np.ndarray, "columns 10"], Float[np.ndarray, "10 10"]]:
        """Best linear parameters for each column of data, and what they leave of its products."""
        return self._eliminated(scale) if self.weight > 0 else self._free

    def _eliminated(
        self, scale: float
    ) -> tuple[Float[np.ndarray, "columns 10"], Float[np.ndarray, "10 10"]]:
        linear = self._solve(scale, self.moments.cross)
        return linear, self.moments.data - self.moments.cross.T @ linear

    def _solve(
        self, scale: float, right: Float[np.ndarray, "columns *right"]
    ) -> Float[np.ndarray, "columns *right"]:
        design = self.moments.design.copy()
        modes = np.arange(len(self.variances))
        design[modes, modes] += self.weight / (scale**2 * self.variances)
        try:
            return np.asarray(cho_solve(cho_factor(design), right))
        except np.linalg.LinAlgError as error:
            raise InputError(
                f"{len(self.variances)} modes cannot be told apart by these correspondences; use "
                "fewer modes or a MAP weight above 0."
            ) from error


class Solution(NamedTuple):
    """Where a separable fit ended, and the objective after each step that was taken."""

    pose: Similarity
    alpha: Float[np.ndarray, "modes"]
    value: float
    history: list[float]
    converged: bool


def solve(
    problem: Separable,
    start: Similarity,
    iterations: int = ITERATIONS,
    tolerance: float = TOLERANCE,
) -> Solution:
    """Gauss-Newton on rotation and scale from `start`, damped after Levenberg.

    Stops when a step would lower the objective by less than `tolerance` of it, or after
    `iterations`.
    """
    best = problem(start.rotation, start.scale)
    history, damping = [best.value], 1e-6
    for _ in range(iterations):
        scaled = best.curvature + damping * np.diag(np.diag(best.curvature))
        step = np.linalg.lstsq(scaled, -best.gradient / 2, rcond=None)[0]
        promised = -(best.gradient @ step) / 2
        if promised <= tolerance * best.value:
            return Solution(best.pose, best.alpha, best.value, history, True)
        rotation = best.pose.rotation @ Rotation.from_rotvec(step[:3]).as_matrix()
        tried = problem(rotation, best.pose.scale * float(np.exp(np.clip(step[3], -1, 1))))
        if tried.value < best.value:
            best, damping = tried, max(damping / 10, 1e-12)
            history.append(best.value)
        else:
            damping *= 10
            if damping > 1e12:
                return Solution(best.pose, best.alpha, best.value, history, True)
    return Solution(best.pose, best.alpha, best.value, history, False)
