"""Least squares of a few bounded parameters for many spectra at once, some bands missing."""

from collections.abc import Callable

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.report import Results

Model = Callable[..., Tensor]

Bounds = tuple[tuple[float, float], ...]

BOUNDS: Bounds = ((0.0, 0.6), (0.0, 0.3))
"""Bounds of f_mel and f_blood, wider than any skin."""


def fit(
    model: Model, target: Float[Tensor, "people value"], bounds: Bounds = BOUNDS
) -> Float[Tensor, "people parameter"]:
    """Fit the parameters of a model to each target, within bounds.

    Levenberg and Marquardt's steps, for all people at once, start at the best point of a coarse
    grid. A parameter that leaves its bounds is clipped, and is held in the step that follows.
    Values that are NaN are missing.
    """
    low, high = torch.tensor(bounds, dtype=torch.float64).T
    f = _choose_start(model, target, low, high)
    damping = torch.full((len(target),), 1e-3, dtype=torch.float64)
    error = _compute_residual(model, f, target).square().sum(-1)
    for _ in range(30):
        trial = (f + _compute_step(model, f, target, damping, low, high)).clamp(low, high)
        tried = _compute_residual(model, trial, target).square().sum(-1)
        better = tried < error
        if (trial - f).abs().max() < 1e-8:
            break
        f, error = torch.where(better[:, None], trial, f), torch.where(better, tried, error)
        damping = torch.where(better, damping / 5, damping * 5).clamp(1e-12, 1e12)
    return f


def _compute_residual(model: Model, f: Tensor, target: Tensor) -> Tensor:
    return (target - model(*f.T)).nan_to_num(nan=0.0)


def _choose_start(model: Model, target: Tensor, low: Tensor, high: Tensor) -> Tensor:
    # Spaced as u^2: the colour changes fastest where a fraction is small.
    axes = [
        a + (b - a) * torch.linspace(0, 1, 40).double() ** 2 for a, b in zip(low, high, strict=True)
    ]
    nodes = torch.cartesian_prod(*axes)
    values, known = model(*nodes.T), (~target.isnan()).double()
    # |target - value|^2 over the known bands, less the part that all nodes share.
    distance = known @ values.square().T - 2 * target.nan_to_num(nan=0.0) @ values.T
    return nodes[distance.argmin(1)]


def _compute_step(
    model: Model, f: Tensor, target: Tensor, damping: Tensor, low: Tensor, high: Tensor
) -> Tensor:
    unit = torch.eye(len(low), dtype=torch.float64)
    here, delta = model(*f.T), 1e-6
    # Finite differences: forward-mode differentiation of such small arrays takes ten times longer.
    J = torch.stack([(model(*(f + delta * e).T) - here) / delta for e in unit], -1)
    J = J * ~target.isnan()[..., None]
    residual = (target - here).nan_to_num(nan=0.0)
    gradient = (J.mT @ residual[..., None])[..., 0]
    held = ((f <= low) & (gradient < 0)) | ((f >= high) & (gradient > 0))
    J = J * ~held[:, None, :]
    normal = J.mT @ J
    ridge = damping[:, None] * normal.diagonal(dim1=-2, dim2=-1) + held + 1e-15
    return torch.linalg.solve(normal + torch.diag_embed(ridge), gradient * ~held)


def compute_rmse(
    recovered: Float[Tensor, "people band"], target: Float[Tensor, "people band"]
) -> Float[Tensor, "people"]:
    """Compute the root mean square error of each spectrum over the bands that are not NaN."""
    return (recovered - target).square().nanmean(-1).sqrt()


def summarise(errors: Float[Tensor, "people"]) -> Results:
    """Compute the median and the 95th percentile."""
    return {"median": errors.quantile(0.5).item(), "p95": errors.quantile(0.95).item()}
