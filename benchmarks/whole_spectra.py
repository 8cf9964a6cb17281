"""What a whole measured spectrum says about its skin: the most probable one under `SkinPrior`."""

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.recovered_spectra import FittedSkin
from skinnet.physics import Nuisance

STEPS, DELTA = 50, 1e-4
LOW, HIGH = -5.5, -0.2
"""Ends of ln f_mel and ln f_blood."""


class SkinFit(NamedTuple):
    """Most probable skins given their spectra, and the normal approximation about them.

    Attributes:
        skins: ln f_mel, ln f_blood, thickness, scattering, oxygenation, baseline.
        covariance: Of the skins.
    """

    skins: Float[Tensor, "people 6"]
    covariance: Float[Tensor, "people 6 6"]


class _Expansion(NamedTuple):
    """Logarithm of the posterior at a skin, its gradient, and minus its expected Hessian."""

    value: Float[Tensor, "people"]
    gradient: Float[Tensor, "people 6"]
    information: Float[Tensor, "people 6 6"]


def fit_skins(
    skin: FittedSkin,
    target: Float[Tensor, "people wavelength"],
    start: Float[Tensor, "people 6"] | None = None,
    steps: int = STEPS,
) -> SkinFit:
    """Fit melanin, blood and nuisance to each spectrum, by Fisher scoring with damping.

    What the prior leaves over at each band is the noise. Bands that are NaN are missing.

    Args:
        skin: Constants and prior.
        target: Measured spectra.
        start: Skins to start from; None: the nearest of a few tones.
        steps: At most as many.
    """
    z = _choose_start(skin, target) if start is None else start
    here, damping = _expand(skin, z, target), torch.full((len(z),), 1e-3, dtype=torch.float64)
    for _ in range(steps):
        ridge = damping[:, None] * here.information.diagonal(dim1=1, dim2=2)
        step = torch.linalg.solve(here.information + torch.diag_embed(ridge), here.gradient)
        trial = torch.cat([(z + step)[:, :2].clamp(LOW, HIGH), (z + step)[:, 2:]], 1)
        there = _expand(skin, trial, target)
        better = there.value > here.value
        z = torch.where(better[:, None], trial, z)
        here = _merge(better, there, here)
        damping = torch.where(better, damping / 5, damping * 5).clamp(1e-9, 1e9)
        if step.abs().max() < 1e-5:
            break
    return SkinFit(z, torch.linalg.inv(here.information))


def _choose_start(skin: FittedSkin, target: Tensor) -> Tensor:
    tones = torch.linspace(-4, -0.7, 25, dtype=torch.float64)
    f_mel, f_blood = tones.exp(), torch.full_like(tones, 0.045)
    mean, _, _ = skin.prior.condition(f_mel)
    spectra = skin.predict(f_mel, f_blood, mean)
    nearest = (target[:, None] - spectra).square().nanmean(-1).argmin(-1)
    return torch.stack([tones, f_blood.log(), *mean], -1)[nearest]


def _merge(better: Tensor, there: _Expansion, here: _Expansion) -> _Expansion:
    value, gradient, information = (
        torch.where(better.reshape(-1, *[1] * (old.ndim - 1)), new, old)
        for new, old in zip(there, here, strict=True)
    )
    return _Expansion(value, gradient, information)


def _expand(skin: FittedSkin, z: Tensor, target: Tensor) -> _Expansion:
    parts = zip(
        _expand_likelihood(skin, z, target),
        _expand_nuisance(skin, z),
        _expand_pigments(skin, z),
        strict=True,
    )
    return _Expansion(*(a + b + c for a, b, c in parts))


def _expand_likelihood(skin: FittedSkin, z: Tensor, target: Tensor) -> _Expansion:
    known = ~target.isnan()
    S, later = (_load_noise(skin, z[:, 0] + shift, known) for shift in (0.0, DELTA))
    steps = DELTA * torch.eye(z.shape[-1] + 1, z.shape[-1], dtype=torch.float64).roll(1, 0)
    here, *moved = _predict(skin, z + steps[:, None])
    J = (torch.stack(moved, -1) - here[..., None]) / DELTA
    return _expand_normal(
        (target - here).nan_to_num(nan=0.0), -J * known[..., None], S, (later - S) / DELTA
    )


def _expand_normal(e: Tensor, slope: Tensor, noise: Tensor, change: Tensor) -> _Expansion:
    """Expand a normal density of e(z) whose covariance depends on ln f_mel too.

    Args:
        e: Deviations from the mean.
        slope: Derivative of the deviations.
        noise: Covariance.
        change: Derivative of the covariance by ln f_mel.
    """
    solved = torch.linalg.solve(noise, torch.cat([slope, e[..., None], change], -1))
    by_z, weighted, relative = solved[..., :6], solved[..., 6], solved[..., 7:]
    gradient, information = -(by_z.mT @ e[..., None])[..., 0], by_z.mT @ slope
    trace = relative.diagonal(dim1=1, dim2=2).sum(-1)
    gradient[:, 0] += 0.5 * ((weighted[:, None] @ change @ weighted[..., None])[:, 0, 0] - trace)
    information[:, 0, 0] += 0.5 * (relative * relative.mT).sum((1, 2))
    value = -0.5 * ((e * weighted).sum(-1) + torch.logdet(noise))
    return _Expansion(value, gradient, information)


def _predict(skin: FittedSkin, z: Tensor) -> Tensor:
    f_mel, f_blood = z[..., :2].exp().unbind(-1)
    nuisance = Nuisance(*z[..., 2:].unbind(-1))
    rest = skin.prior.leftover_mean(f_mel, nuisance, f_blood)
    return skin.predict(f_mel, f_blood, nuisance) + rest


def _load_noise(skin: FittedSkin, tone: Tensor, known: Tensor) -> Tensor:
    """Return what the prior leaves over, with a variance of one, for itself, at missing bands."""
    _, _, leftover = skin.prior.condition(tone.exp())
    both = known[:, :, None] & known[:, None, :]
    return leftover * both + torch.diag_embed((~known).double())


def _expand_nuisance(skin: FittedSkin, z: Tensor) -> _Expansion:
    tone, blood = DELTA * torch.eye(6, dtype=torch.float64)[:2]
    e, covariance = _compare_nuisance(skin, z)
    darker, changed = _compare_nuisance(skin, z + tone)
    redder, _ = _compare_nuisance(skin, z + blood)
    by_pigments = torch.stack([darker - e, redder - e], -1) / DELTA
    unit = torch.eye(4, dtype=torch.float64).expand(len(z), 4, 4)
    slope = torch.cat([by_pigments, unit], -1)
    return _expand_normal(e, slope, covariance, (changed - covariance) / DELTA)


def _compare_nuisance(skin: FittedSkin, z: Tensor) -> tuple[Tensor, Tensor]:
    """Return the deviations of the nuisance from the prior's mean, and its covariance."""
    mean, covariance, _ = skin.prior.condition(z[:, 0].exp(), z[:, 1].exp())
    return z[:, 2:] - torch.stack(list(mean), -1), covariance


def _expand_pigments(skin: FittedSkin, z: Tensor) -> _Expansion:
    # As in expectation maximisation: a skin belongs to each component with some probability.
    prior, x = skin.prior, z[:, None, :2]
    normal = torch.distributions.MultivariateNormal(prior.means, prior.covariances)
    log_joint = prior.weights.log() + normal.log_prob(x)
    P = log_joint.softmax(-1)[..., None, None] * torch.linalg.inv(prior.covariances)
    toward = (P @ (prior.means - x)[..., None]).sum(1)[..., 0]
    gradient, information = torch.zeros_like(z), torch.zeros(len(z), 6, 6, dtype=z.dtype)
    gradient[:, :2], information[:, :2, :2] = toward, P.sum(1)
    return _Expansion(log_joint.logsumexp(-1), gradient, information)
