"""Nonlinear least squares for parameters of each record and parameters that all records share.

Levenberg and Marquardt's method on |w (model(x, z) - y)|^2 + |z|^2, with x [record, own] and z
[shared] in units of a normal prior about 0. In each step the records' own parameters are eliminated
(Schur complement), so that a thousand unknowns cost as little as ten.
"""

from collections.abc import Callable
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

Model = Callable[[Tensor, Tensor], Tensor]

_STEP = 1e-6


class Fit(NamedTuple):
    """Parameters of each record, shared parameters, and the latter's posterior covariance."""

    own: Float[Tensor, "record own"]
    shared: Float[Tensor, "shared"]
    covariance: Float[Tensor, "shared shared"]


class Problem(NamedTuple):
    """What is fitted: model, target with NaN where nothing was measured, weights and bounds."""

    model: Model
    target: Float[Tensor, "record value"]
    weight: Float[Tensor, "record"]
    low: Float[Tensor, "own"]
    high: Float[Tensor, "own"]

    def compute_residuals(self, own: Tensor, shared: Tensor) -> Float[Tensor, "record value"]:
        """Compute the weighted residuals, 0 where nothing was measured."""
        return (self.model(own, shared) - self.target).nan_to_num() * self.weight[:, None]


def fit_jointly(problem: Problem, own: Tensor, shared: Tensor, steps: int = 60) -> Fit:
    """Minimise over the records' own and the shared parameters."""
    own = fit_own(problem, own, shared)
    error, damping = _compute_error(problem, own, shared), 1e-3
    for _ in range(steps):
        system = _linearise(problem, own, shared)
        for _ in range(8):
            new_own, new_shared = _step(problem, system, own, shared, damping)
            new_error = _compute_error(problem, new_own, new_shared)
            if new_error < error:
                break
            damping *= 6
        else:
            break
        gain, error = error - new_error, min(error, new_error)
        own, shared, damping = new_own, new_shared, damping / 4
        if gain < 1e-9 * error:
            break
    return Fit(own, shared, torch.linalg.inv(_reduce(_linearise(problem, own, shared), 0.0)[0]))


def fit_own(problem: Problem, own: Tensor, shared: Tensor, steps: int = 40) -> Tensor:
    """Minimise over the records' own parameters alone."""
    damping = torch.full((len(own),), 1e-3, dtype=own.dtype)
    error = problem.compute_residuals(own, shared).square().sum(1)
    for _ in range(steps):
        r, J = _differentiate_own(problem, own, shared)
        normal = J.mT @ J
        ridge = damping[:, None] * normal.diagonal(dim1=1, dim2=2) + 1e-12
        step = torch.linalg.solve(normal + torch.diag_embed(ridge), (J.mT @ r[..., None])[..., 0])
        trial = (own - step).clamp(problem.low, problem.high)
        tried = problem.compute_residuals(trial, shared).square().sum(1)
        better, moved = tried < error, (trial - own).abs().max()
        own, error = torch.where(better[:, None], trial, own), torch.where(better, tried, error)
        damping = torch.where(better, damping / 5, damping * 5).clamp(1e-9, 1e6)
        if moved < 1e-8:
            break
    return own


def compute_newton_step(problem: Problem, own: Tensor, shared: Tensor) -> tuple[Tensor, Tensor]:
    """Compute the shared parameters' next step and their posterior standard deviation.

    Where the step is small beside the deviation, the parameters are a minimum.
    """
    matrix, gradient = _reduce(_linearise(problem, fit_own(problem, own, shared), shared), 0.0)
    return -torch.linalg.solve(matrix, gradient), torch.linalg.inv(matrix).diagonal().sqrt()


class _System(NamedTuple):
    own: Tensor
    both: Tensor
    shared: Tensor
    own_gradient: Tensor
    shared_gradient: Tensor


def _compute_error(problem: Problem, own: Tensor, shared: Tensor) -> float:
    error = float(problem.compute_residuals(own, shared).square().sum() + shared @ shared)
    return error if error == error else float("inf")


def _differentiate_own(problem: Problem, own: Tensor, shared: Tensor) -> tuple[Tensor, Tensor]:
    r = problem.compute_residuals(own, shared)
    unit = _STEP * torch.eye(own.shape[1], dtype=own.dtype)
    J = [(problem.compute_residuals(own + e, shared) - r) / _STEP for e in unit]
    return r, torch.stack(J, -1)


def _linearise(problem: Problem, own: Tensor, shared: Tensor) -> _System:
    r, J = _differentiate_own(problem, own, shared)
    unit = _STEP * torch.eye(len(shared), dtype=own.dtype)
    G = torch.stack([(problem.compute_residuals(own, shared + e) - r) / _STEP for e in unit], -1)
    # A parameter at its bound that would leave it is held.
    gradient = torch.einsum("nli,nl->ni", J, r)
    held = ((own <= problem.low) & (gradient > 0)) | ((own >= problem.high) & (gradient < 0))
    J = J * ~held[:, None, :]
    return _System(
        J.mT @ J + 1e-12 * torch.eye(own.shape[1], dtype=own.dtype),
        J.mT @ G,
        torch.einsum("nli,nlj->ij", G, G) + torch.eye(len(shared), dtype=own.dtype),
        gradient * ~held,
        torch.einsum("nli,nl->i", G, r) + shared,
    )


def _reduce(system: _System, damping: float) -> tuple[Tensor, Tensor]:
    damped = system.own * (1 + damping * torch.eye(system.own.shape[-1], dtype=system.own.dtype))
    gain = torch.linalg.solve(damped, system.both)
    shared = system.shared * (1 + damping * torch.eye(len(system.shared), dtype=gain.dtype))
    matrix = shared - torch.einsum("nia,nib->ab", system.both, gain)
    return matrix, system.shared_gradient - torch.einsum("nia,ni->a", gain, system.own_gradient)


def _step(
    problem: Problem, system: _System, own: Tensor, shared: Tensor, damping: float
) -> tuple[Tensor, Tensor]:
    matrix, gradient = _reduce(system, damping)
    step = -torch.linalg.solve(matrix, gradient)
    damped = system.own * (1 + damping * torch.eye(own.shape[1], dtype=own.dtype))
    right = system.own_gradient + system.both @ step
    moved = own - torch.linalg.solve(damped, right[..., None])[..., 0]
    return moved.clamp(problem.low, problem.high), shared + step
