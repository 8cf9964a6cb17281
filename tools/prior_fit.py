"""The distribution of skins, fitted to spectra by expectation maximisation."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import torch
from benchmarks.recovered_spectra import FittedSkin
from benchmarks.whole_spectra import fit_skins
from jaxtyping import Float
from torch import Tensor

from skinnet.physics import Nuisance, SkinOptics, SkinPrior
from skinnet.physics.prior import TYPICAL_F_MEL

FOREARMS = 0.3
"""Weight of the forearms; the skins of many peoples have the rest."""

TONES, WIDTH = (-3.0, -2.55, -2.1, -1.65, -1.2), 0.3
"""Tones (ln f_mel) whose left-over covariance is estimated, and the width of a tone."""

RANK = 6
"""Factors of a left-over covariance; the rest is independent at each band."""

NUISANCE = (0.6, 0.3, 0.1, 0.2)
"""Prior deviations of the nuisance: thickness, scattering, oxygenation, baseline."""

_PRIOR_WEIGHT, _SHRINKAGE, _LEAST_VARIANCE = 0.02, 8.0, 1e-6
_LEFTOVER = 0.003
_COUNT, _ROUNDS, _STEPS = 3, 14, 3


class Statistics(NamedTuple):
    """What the skins are, given their spectra.

    Attributes:
        skins: ln f_mel, ln f_blood and nuisance.
        covariance: Of the skins.
        residual: What the model leaves over, NaN at missing bands.
        weight: Weight of each skin, of unit sum.
    """

    skins: Float[Tensor, "people 6"]
    covariance: Float[Tensor, "people 6 6"]
    residual: Float[Tensor, "people wavelength"]
    weight: Float[Tensor, "people"]


def fit_prior(
    optics: SkinOptics,
    r_surface: float,
    forearms: Float[Tensor, "people wavelength"],
    issa: Float[Tensor, "records wavelength"],
) -> dict[str, Any]:
    """Fit the record of a `SkinPrior` to two sets of spectra."""
    target = torch.cat([forearms, issa])
    weight = torch.cat(
        [
            torch.full((len(one),), share / len(one), dtype=torch.float64)
            for one, share in ((forearms, FOREARMS), (issa, 1 - FOREARMS))
        ]
    )
    record, skins = _make_first_record(), None
    for _ in range(_ROUNDS):
        skin = FittedSkin(optics, r_surface, SkinPrior(record))
        fit = fit_skins(skin, target, skins, _STEPS if skins is not None else 30)
        skins = fit.skins
        residual = target - skin.predict(*_split(skins))
        record = _maximise(Statistics(skins, fit.covariance, residual, weight), record)
    return record


def _split(skins: Float[Tensor, "people 6"]) -> tuple[Tensor, Tensor, Nuisance]:
    f_mel, f_blood, *nuisance = skins.unbind(-1)
    return f_mel.exp(), f_blood.exp(), Nuisance(*nuisance)


def _make_first_record() -> dict[str, Any]:
    """Start with a broad distribution, the same at every tone."""
    tones = torch.tensor(TONES)
    bands = torch.arange(33.0)
    near = _LEFTOVER**2 * torch.exp(-(bands[:, None] - bands).abs() / 4)
    leftover = (near + (_LEFTOVER / 2) ** 2 * torch.eye(33)).expand(len(tones), 33, 33)
    means = torch.stack([torch.tensor([-2.8, -2.1, -1.3]), torch.full((_COUNT,), -3.2)], -1)
    return {
        "mixture": {
            "weights": [1 / _COUNT] * _COUNT,
            "means": means.tolist(),
            "covariances": (0.3 * torch.eye(2)).expand(_COUNT, 2, 2).tolist(),
        },
        "nuisance": {
            "coefficients": [[0.0] * 4] * 2,
            "covariance": torch.diag(torch.tensor(NUISANCE) ** 2).tolist(),
        },
        "leftover": _factorise(leftover.double()),
    }


def _maximise(statistics: Statistics, record: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "mixture": _fit_mixture(statistics, SkinPrior(record)),
        "nuisance": _fit_nuisance(statistics),
        "leftover": _factorise(_fit_leftover(statistics)),
    }


def _fit_mixture(statistics: Statistics, prior: SkinPrior) -> dict[str, Any]:
    x, spread = statistics.skins[:, :2], statistics.covariance[:, :2, :2]
    normal = torch.distributions.MultivariateNormal(prior.means, prior.covariances)
    log_joint = prior.weights.log() + normal.log_prob(x[:, None])  # type: ignore[no-untyped-call]
    share = log_joint.softmax(-1) * statistics.weight[:, None]
    weights = share.sum(0)
    means = share.T @ x / weights[:, None]
    e = x[:, None] - means
    square = e[..., :, None] * e[..., None, :] + spread[:, None]
    covariances = (share[..., None, None] * square).sum(0) / weights[:, None, None]
    covariances = covariances + 0.003 * torch.eye(2)
    return {
        "weights": weights.tolist(),
        "means": means.tolist(),
        "covariances": covariances.tolist(),
    }


def _fit_nuisance(statistics: Statistics) -> dict[str, Any]:
    """Regress the nuisance on ln f_mel; the prior counts as a share of all skins."""
    weight, nuisance = statistics.weight, statistics.skins[:, 2:]
    tone = statistics.skins[:, 0] - torch.tensor(TYPICAL_F_MEL).log()
    design = torch.stack([torch.ones_like(tone), tone], -1)
    normal = design.T @ (weight[:, None] * design) + torch.diag(torch.tensor([1e-3, 0.02]).double())
    coefficients = torch.linalg.solve(normal, design.T @ (weight[:, None] * nuisance))
    e = nuisance - design @ coefficients
    spread = e[:, :, None] * e[:, None] + statistics.covariance[:, 2:, 2:]
    covariance = (weight[:, None, None] * spread).sum(0)
    prior = torch.diag(torch.tensor(NUISANCE).double() ** 2)
    mixed = (1 - _PRIOR_WEIGHT) * covariance + _PRIOR_WEIGHT * prior
    return {"coefficients": coefficients.tolist(), "covariance": mixed.tolist()}


def _fit_leftover(statistics: Statistics) -> Float[Tensor, "tones wavelength wavelength"]:
    """Estimate the covariance of residuals near each tone, drawn to independent bands."""
    known = (~statistics.residual.isnan()).double()
    r = statistics.residual.nan_to_num(nan=0.0)
    found = []
    for tone in TONES:
        near = torch.exp(-0.5 * ((statistics.skins[:, 0] - tone) / WIDTH) ** 2)
        share = near * statistics.weight
        share = share / share.sum()
        both = known.T @ (share[:, None] * known)
        S = (r.T @ (share[:, None] * r)) / both.clamp_min(1e-6)
        effective = 1 / share.square().sum()
        shrink = _SHRINKAGE / (_SHRINKAGE + effective)
        found.append((1 - shrink) * S + shrink * torch.diag(S.diagonal()))
    return torch.stack(found)


def _factorise(covariance: Float[Tensor, "tones wavelength wavelength"]) -> dict[str, Any]:
    """Write covariances as factors and independent variances, which takes a fifth of the space."""
    values, vectors = torch.linalg.eigh(covariance)
    factors = vectors[..., -RANK:] * values[..., None, -RANK:].clamp_min(0).sqrt()
    rest = covariance.diagonal(dim1=1, dim2=2) - factors.square().sum(-1)
    return {
        "tones": list(TONES),
        "width": WIDTH,
        "factors": factors.tolist(),
        "variances": rest.clamp_min(_LEAST_VARIANCE).tolist(),
    }
