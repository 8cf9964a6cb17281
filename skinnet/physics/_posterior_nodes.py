"""Skins on a grid of melanin and blood, each with the distribution of its colours."""

import math
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics.nuisance import Nuisance
from skinnet.physics.prior import SkinPrior
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.specular import R_SURFACE

_MELS, _BLOODS = 96, 32
"""Nodes in ln f_mel and ln f_blood. The step is below 1.5 standard deviations of the posterior,
where a sum over nodes differs from the integral by less than a thousandth."""

_LOW_MEL, _LOW_BLOOD, _SCAN = 1e-3, 5e-4, 128
"""Least fractions, and nodes along each axis, of the scan that finds where the prior is."""

_DEPTH = 14.0
"""How far ln density is below its maximum where a skin is left out: 5.3 standard deviations."""


class PosteriorNodes(NamedTuple):
    """Skins that the prior holds possible, and the normal distribution of each one's colours.

    Attributes:
        log_prior: Logarithm of the prior density.
        colour: Mean colour, linear RGB.
        covariance: Covariance of the colours, from nuisance, left-over, white balance and noise.
        moments: Of each node: ln f_mel and its square, ln f_blood and its square, f_mel, f_mel^2,
            f_blood, f_blood^2; mean and mean square of ln f_blood in the prior given f_mel.
        mel_variance: Variance of ln f_mel in the prior.
    """

    log_prior: Float[Tensor, "nodes"]
    colour: Float[Tensor, "nodes 3"]
    covariance: Float[Tensor, "nodes 3 3"]
    moments: Float[Tensor, "nodes 10"]
    mel_variance: float


@torch.no_grad()
def tabulate_nodes(
    reflectance: SkinReflectance,
    matrix: Float[Tensor, "wavelength 3"],
    prior: SkinPrior,
    noise: float,
    white_balance: float,
) -> PosteriorNodes:
    """Compute the distribution of colours of every skin that the prior holds possible, float64."""
    mel, blood = _find_axes(prior)
    log_prior = prior.log_density(mel.exp()[:, None], blood.exp())
    colour, covariance = _predict(reflectance, matrix, prior, mel.exp()[:, None], blood.exp())
    gains = torch.tensor([white_balance, 0.0, white_balance], dtype=torch.float64)
    covariance = covariance + torch.diag_embed((gains * colour) ** 2 + noise**2)
    moments, mel_variance = _tabulate_moments(mel, blood, log_prior)
    possible = log_prior > log_prior.max() - _DEPTH
    return PosteriorNodes(
        log_prior[possible],
        colour[possible],
        covariance[possible],
        moments[possible],
        mel_variance,
    )


def _find_axes(prior: SkinPrior) -> tuple[Float[Tensor, "mel"], Float[Tensor, "blood"]]:
    """Nodes of ln f_mel and of ln f_blood that cover the prior."""
    axes = [_space(math.log(low), 0.0, _SCAN) for low in (_LOW_MEL, _LOW_BLOOD)]
    density = prior.log_density(axes[0].exp()[:, None], axes[1].exp())
    possible = density > density.max() - _DEPTH
    mel, blood = (axis[possible.any(1 - k)] for k, axis in enumerate(axes))
    ends = [(float(axis[0]), float(axis[-1])) for axis in (mel, blood)]
    return _space(*ends[0], _MELS), _space(*ends[1], _BLOODS)


def _space(low: float, high: float, count: int) -> Float[Tensor, "count"]:
    return torch.linspace(low, high, count, dtype=torch.float64)


def _predict(
    reflectance: SkinReflectance,
    matrix: Float[Tensor, "wavelength 3"],
    prior: SkinPrior,
    f_mel: Float[Tensor, "mel 1"],
    f_blood: Float[Tensor, "blood"],
) -> tuple[Float[Tensor, "mel blood 3"], Float[Tensor, "mel blood 3 3"]]:
    """Mean and covariance of colours over nuisance and left-over, of each skin.

    The nuisance takes eight values of equal weight, two standard deviations from its mean along
    each column of the covariance's root. They have the moments of the normal distribution up to
    the third: spherical-radial cubature (Arasaratnam & Haykin 2009). Derivatives at the mean would
    not do, because the depth of the dermis varies by a factor of two.
    """
    mean, nuisance_covariance, leftover = prior.condition(f_mel, f_blood)
    root = 2 * torch.linalg.cholesky(nuisance_covariance)
    centre = torch.stack(list(mean), -1)
    colours = []
    for step in (*root.unbind(-1), *(-root).unbind(-1)):
        nuisance = Nuisance(*(centre + step).unbind(-1))
        # What is left over is of measured spectra, which the surface of skin makes paler.
        rest = prior.leftover_mean(f_mel, nuisance, f_blood) / (1 - R_SURFACE)
        colours.append((reflectance.bands(f_mel, f_blood, nuisance) + rest) @ matrix)
    points = torch.stack(colours)
    colour = points.mean(0)
    deviations = (points - colour).movedim(0, -1)
    spread = deviations @ deviations.mT / len(points)
    return colour, spread + matrix.mT @ leftover @ matrix / (1 - R_SURFACE) ** 2


def _tabulate_moments(
    mel: Float[Tensor, "mel"], blood: Float[Tensor, "blood"], log_prior: Float[Tensor, "mel blood"]
) -> tuple[Float[Tensor, "mel blood 10"], float]:
    given_mel = torch.softmax(log_prior, 1)
    blood_given_mel = [(given_mel @ power)[:, None] for power in (blood, blood**2)]
    of_mel = torch.softmax(log_prior.logsumexp(1), 0)
    mel_variance = float(of_mel @ mel**2 - (of_mel @ mel) ** 2)
    column, row = mel[:, None], blood[None, :]
    logarithms = (column, column**2, row, row**2)
    fractions = (column.exp(), (2 * column).exp(), row.exp(), (2 * row).exp())
    values = torch.broadcast_tensors(*logarithms, *fractions, *blood_given_mel)
    return torch.stack(values, -1), mel_variance
