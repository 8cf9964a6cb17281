"""The distribution of skins over people, fitted to their spectra in two steps.

First each spectrum is fitted by melanin, blood and nuisance. How far the nuisance varies, and how
well the model fits at each tone, decides how the fit weighs them, and is found with the fits
themselves by expectation maximisation; its result is the reference. Then the distribution of these
fits, and of what they leave over, is described: that is the prior.
"""

import math
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.recovered_spectra import FittedSkin
from benchmarks.whole_spectra import fit_skins
from skinnet.physics import Nuisance, SkinOptics, SkinPrior
from skinnet.physics.prior import TYPICAL_F_BLOOD, TYPICAL_F_MEL

Record = dict[str, Any]

FOREARMS = 0.4
"""Weight of the forearms; the skins of many peoples have the rest. It decides how skins of a tone
vary; more costs the latter's 95th percentile in cross-validation, less the former's median. How
frequent a tone is, every record decides alike: the forearms are of one laboratory."""

TONES, WIDTH = tuple(math.log(f_mel) for f_mel in (0.045, 0.065, 0.09, 0.13, 0.19, 0.28)), 0.25
"""Tones (ln f_mel) at which covariances are estimated, and the width of a tone."""

REFERENCE_WIDTH = 0.45

RANK = 6
"""Factors of a left-over covariance; the rest is independent at each band."""

NUISANCE = (0.6, 0.3, 0.1, 0.2)
"""Prior deviations of the nuisance: thickness, scattering, oxygenation, baseline."""

_PRIOR_WEIGHT, _SHRINKAGE, _MEAN_SHRINKAGE, _LEAST_VARIANCE = 0.15, 8.0, 4.0, 1e-6
"""Weight of the nuisance's prior in the reference; records that a prior of a tone counts as."""

_PARAMETERS = 3
"""Coefficients about which the nuisance varies: a constant, melanin, and blood. What n records
vary about them is less than what others will, by the final prediction error's (n + p) / (n - p),
nearly 1 + 2 p / n (Akaike 1970)."""

_LEFTOVER, _COMPONENTS, _ROUNDS, _STEPS = 0.003, 3, 12, 3
_LEAST_SPREAD = 0.003
"""Variance that is added to each component of the mixture."""


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
) -> tuple[Record, Record]:
    """Fit the records of two priors: the distribution of skins, and the fits' reference."""
    target, weight = torch.cat([forearms, issa]), _weigh(len(forearms), len(issa))
    reference, skins = make_first_record(), None
    for _ in range(_ROUNDS):
        skin = FittedSkin(optics, r_surface, SkinPrior(reference))
        fit = fit_skins(skin, target, skins, 30 if skins is None else _STEPS)
        skins = fit.skins
        f_mel, f_blood, *nuisance = skins.unbind(-1)
        residual = target - skin.predict(f_mel.exp(), f_blood.exp(), Nuisance(*nuisance))
        found = Statistics(skins, fit.covariance, residual, weight)
        reference = _make_reference(found)
    return describe_fits(found), reference


def describe_fits(fits: Statistics) -> Record:
    """Describe the distribution of fits, and of what they leave over.

    A fit is drawn towards its reference, so that what it leaves over goes with blood and nuisance.
    """
    skins, weight = fits.skins, fits.weight
    known, residual = (~fits.residual.isnan()).double(), fits.residual.nan_to_num(nan=0.0)
    coefficients, e = _regress(skins, weight, blood=True)
    blood = skins[:, 1:2] - math.log(TYPICAL_F_BLOOD)
    x = torch.cat([e, blood], -1)
    slopes = torch.linalg.solve(
        x.T @ (weight[:, None] * x) + 1e-5 * torch.eye(5), x.T @ (weight[:, None] * residual)
    )
    residual = (residual - x @ slopes) * known
    overall = _compute_moment(e, weight)
    nuisance, means, leftover = [], [], []
    for tone in TONES:
        near, shrink = _find_near(fits, tone, WIDTH)
        count = 1 / near.square().sum()
        ratio = 1 + 2 * _PARAMETERS / count
        nuisance.append(ratio * ((1 - shrink) * _compute_moment(e, near) + shrink * overall))
        mean = near @ residual / (near @ known) * count / (count + _MEAN_SHRINKAGE)
        means.append(mean)
        moment = _compute_moment((residual - mean) * known, near, known)
        leftover.append(ratio * _shrink(moment, shrink))
    return {
        "tones": list(TONES),
        "width": WIDTH,
        "mixture": _fit_mixture(skins[:, :2], torch.full_like(weight, 1 / len(weight))),
        "nuisance": {
            "coefficients": coefficients.tolist(),
            "covariances": torch.stack(nuisance).tolist(),
        },
        "leftover": _factorise(torch.stack(leftover), torch.stack(means), slopes),
    }


def _weigh(forearms: int, issa: int) -> Float[Tensor, "people"]:
    shares = (FOREARMS / forearms, (1 - FOREARMS) / issa)
    return torch.tensor(shares).double().repeat_interleave(torch.tensor((forearms, issa)))


def make_first_record() -> Record:
    """Start with a broad distribution, the same at every tone."""
    bands = torch.arange(33.0).double()
    near = _LEFTOVER**2 * torch.exp(-(bands[:, None] - bands).abs() / 4)
    leftover = near + (_LEFTOVER / 1.5) ** 2 * torch.eye(33)
    prior = torch.diag(torch.tensor(NUISANCE).double() ** 2)
    return _make_record(leftover.expand(len(TONES), 33, 33), torch.zeros(3, 4), prior, (-3.1, 0.36))


def _make_reference(fits: Statistics) -> Record:
    """Estimate how the fits weigh: nuisance and blood with their uncertainty, and the left-over.

    Melanin is free. What is left over has no mean: it is the model's error.
    """
    weight, known = fits.weight, (~fits.residual.isnan()).double()
    residual = fits.residual.nan_to_num(nan=0.0)
    coefficients, e = _regress(fits.skins, weight, blood=False)
    spread = torch.einsum("n,nij->ij", weight, fits.covariance)
    prior = torch.diag(torch.tensor(NUISANCE).double() ** 2)
    nuisance = (1 - _PRIOR_WEIGHT) * (_compute_moment(e, weight) + spread[2:, 2:])
    leftover = []
    for tone in TONES:
        near, shrink = _find_near(fits, tone, REFERENCE_WIDTH)
        leftover.append(_shrink(_compute_moment(residual, near, known), shrink))
    mean = weight @ fits.skins[:, 1]
    variance = weight @ (fits.skins[:, 1] - mean).square() + spread[1, 1]
    blood = (float(mean), float(variance))
    return _make_record(
        torch.stack(leftover), coefficients, nuisance + _PRIOR_WEIGHT * prior, blood
    )


def _make_record(
    leftover: Tensor, coefficients: Tensor, nuisance: Tensor, blood: tuple[float, float]
) -> Record:
    mean, variance = blood
    return {
        "tones": list(TONES),
        "width": WIDTH,
        "mixture": {
            "weights": [1.0],
            "means": [[math.log(TYPICAL_F_MEL), mean]],
            "covariances": [[[1.5**2, 0.0], [0.0, variance]]],
        },
        "nuisance": {
            "coefficients": coefficients.tolist(),
            "covariances": nuisance.expand(len(TONES), 4, 4).tolist(),
        },
        "leftover": _factorise(leftover, torch.zeros(len(TONES), 33), torch.zeros(5, 33)),
    }


def _regress(skins: Tensor, weight: Tensor, blood: bool) -> tuple[Tensor, Tensor]:
    """Regress the nuisance on the fractions; return coefficients and deviations."""
    origin = torch.tensor([TYPICAL_F_MEL, TYPICAL_F_BLOOD], dtype=torch.float64).log()
    pigments = skins[:, :2] - origin
    if not blood:
        pigments = pigments * torch.tensor([1.0, 0.0])
    design = torch.cat([torch.ones_like(pigments[:, :1]), pigments], -1)
    normal = design.T @ (weight[:, None] * design) + 1e-3 * torch.eye(3)
    coefficients = torch.linalg.solve(normal, design.T @ (weight[:, None] * skins[:, 2:]))
    return coefficients, skins[:, 2:] - design @ coefficients


def _find_near(fits: Statistics, tone: float, width: float) -> tuple[Tensor, float]:
    """Return the weights of skins near a tone, and the share of the prior among them."""
    near = torch.exp(-0.5 * ((fits.skins[:, 0] - tone) / width) ** 2) * fits.weight
    near = near / near.sum()
    return near, _SHRINKAGE / (_SHRINKAGE + 1 / float(near.square().sum()))


def _compute_moment(x: Tensor, weight: Tensor, known: Tensor | None = None) -> Tensor:
    moment = x.T @ (weight[:, None] * x)
    if known is None:
        return moment
    return moment / (known.T @ (weight[:, None] * known)).clamp_min(1e-6)


def _shrink(covariance: Tensor, share: float) -> Tensor:
    """Shrink a covariance to independent bands."""
    return (1 - share) * covariance + share * torch.diag(covariance.diagonal())


def _fit_mixture(x: Float[Tensor, "people 2"], weight: Tensor) -> Record:
    middle = torch.quantile(x[:, 0], torch.linspace(0.15, 0.85, _COMPONENTS).double())
    means = torch.stack([middle, x[:, 1].mean().expand(_COMPONENTS)], -1)
    weights = torch.full((_COMPONENTS,), 1 / _COMPONENTS).double()
    covariances = torch.cov(x.T).expand(_COMPONENTS, 2, 2) / _COMPONENTS
    for _ in range(200):
        normal = torch.distributions.MultivariateNormal(means, covariances)
        log_joint = weights.log() + normal.log_prob(x[:, None])
        share = log_joint.softmax(-1) * weight[:, None]
        weights = share.sum(0)
        means = share.T @ x / weights[:, None]
        e = x[:, None] - means
        moment = torch.einsum("nk,nki,nkj->kij", share, e, e) / weights[:, None, None]
        covariances = moment + _LEAST_SPREAD * torch.eye(2)
    return {
        "weights": weights.tolist(),
        "means": means.tolist(),
        "covariances": covariances.tolist(),
    }


def _factorise(covariance: Tensor, means: Tensor, slopes: Tensor) -> Record:
    """Write covariances as factors and independent variances, which takes a fifth of the space."""
    values, vectors = torch.linalg.eigh(covariance)
    factors = vectors[..., -RANK:] * values[..., None, -RANK:].clamp_min(0).sqrt()
    rest = covariance.diagonal(dim1=1, dim2=2) - factors.square().sum(-1)
    return {
        "means": means.tolist(),
        "slopes": slopes.tolist(),
        "factors": factors.tolist(),
        "variances": rest.clamp_min(_LEAST_VARIANCE).tolist(),
    }
