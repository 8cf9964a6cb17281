"""Spectra recovered from their colour alone: the posterior of skins under `SkinPrior`."""

import math
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics import (
    Nuisance,
    SkinOptics,
    SkinPrior,
    SkinReflectance,
    include_specular,
    load_light,
    load_observer,
    spectrum_to_srgb,
)

NOISE = 1e-4
"""Standard deviation of a colour's values."""

F_MEL, F_BLOOD, THICKNESSES = (0.008, 0.8, 120), (0.002, 0.4, 32), 5
"""Least and largest fraction and count of nodes, and the count of thicknesses at each."""


class FittedSkin(NamedTuple):
    """What is fitted to measured spectra: constants, the instrument's surface, and the prior.

    The fits of whole spectra, whose distribution the prior is, have a broader prior, `reference`;
    None: the prior itself.
    """

    optics: SkinOptics
    r_surface: float
    prior: SkinPrior
    reference: SkinPrior | None = None

    def predict(
        self,
        f_mel: Float[Tensor, "*#batch"],
        f_blood: Float[Tensor, "*#batch"],
        nuisance: Nuisance | None = None,
    ) -> Float[Tensor, "*batch wavelength"]:
        """Compute what the instrument measures."""
        skin = SkinReflectance(self.optics, dtype=torch.float64)
        return include_specular(skin.bands(f_mel, f_blood, nuisance), self.r_surface)


class ColourPosterior(NamedTuple):
    """Mean spectra of skins given their colours, and the weights of both fractions' nodes."""

    spectra: Float[Tensor, "people wavelength"]
    f_mel: Float[Tensor, "people node"]
    f_blood: Float[Tensor, "people node"]


class SkinNodes:
    """Skins on a grid of ln f_mel, ln f_blood and thickness, each with the spread about it.

    The other nuisance and what the prior leaves over are normal about each node, and the model is
    linear in them there: given a colour, the spectrum is then normal with a known mean.
    """

    def __init__(self, skin: FittedSkin) -> None:
        matrix = load_d65_matrix()
        self.f_mel, self.f_blood = _space(*F_MEL), _space(*F_BLOOD)
        f_mel, f_blood = torch.cartesian_prod(self.f_mel, self.f_blood).unbind(-1)
        nuisance, shares, spread = _split_nuisance(skin.prior, f_mel, f_blood)
        spectra, J = _linearise(skin, f_mel[:, None], f_blood[:, None], nuisance)
        _, _, leftover = skin.prior.condition(self.f_mel)
        left = (leftover @ matrix).repeat_interleave(len(self.f_blood), 0)
        covariance = J @ spread[:, None] @ (J.mT @ matrix) + left[:, None]
        colours = matrix.mT @ covariance + NOISE**2 * torch.eye(3, dtype=torch.float64)
        density = skin.prior.log_density(f_mel, f_blood)[:, None] + shares.log()
        self.log_weights = (density - 0.5 * torch.logdet(colours)).flatten()
        self.precision = torch.linalg.inv(colours).flatten(0, 1)
        self.gain = covariance.flatten(0, 1) @ self.precision
        self.colours = (spectra @ matrix).flatten(0, 1)
        self.offset = spectra.flatten(0, 1) - (self.gain @ self.colours[..., None])[..., 0]

    def infer(self, rgb: Float[Tensor, "people 3"]) -> ColourPosterior:
        """Compute the posterior of skins from linear sRGB under D65."""
        parts = [self._infer(part) for part in rgb.split(16)]
        return ColourPosterior(*(torch.cat(values) for values in zip(*parts, strict=True)))

    def _infer(self, rgb: Tensor) -> ColourPosterior:
        e = rgb[:, None] - self.colours
        distance = ((e[..., None, :] @ self.precision)[..., 0, :] * e).sum(-1)
        w = torch.softmax(self.log_weights - 0.5 * distance, -1)
        gain = (w @ self.gain.flatten(1)).unflatten(1, (-1, 3))
        spectra = w @ self.offset + (gain @ rgb[..., None])[..., 0]
        w = w.reshape(len(rgb), len(self.f_mel), len(self.f_blood), -1)
        return ColourPosterior(spectra, w.sum((2, 3)), w.sum((1, 3)))


def load_d65_matrix() -> Float[Tensor, "wavelength 3"]:
    """Load the spectrum-to-sRGB matrix of D65, with the standard observer as the camera."""
    return spectrum_to_srgb(load_light("D6504K"), load_observer(), load_observer())


def make_exact(
    spectra: Float[Tensor, "people wavelength"], rgb: Float[Tensor, "people 3"]
) -> Float[Tensor, "people wavelength"]:
    """Change spectra as little as possible, so that their colour under D65 is the given one."""
    matrix = load_d65_matrix()
    change: Tensor = torch.linalg.pinv(matrix)
    return spectra + (rgb - spectra @ matrix) @ change


def compute_interval(
    nodes: Float[Tensor, "node"], weights: Float[Tensor, "people node"], share: float = 0.9
) -> tuple[Float[Tensor, "people"], Float[Tensor, "people"]]:
    """Compute the ends of the central interval that holds a share of the posterior.

    The density is constant between the midpoints of ln f's nodes.
    """
    grid, total = nodes.log().numpy(), weights.cumsum(-1).numpy()
    step = grid[1] - grid[0]
    edges = np.append(grid - step / 2, grid[-1] + step / 2)
    total = np.concatenate([np.zeros((len(total), 1)), total / total[:, -1:]], 1)
    tails = ((1 - share) / 2, (1 + share) / 2)
    ends = np.array([np.interp(tails, each, edges) for each in total])
    low, high = torch.from_numpy(ends).exp().unbind(-1)
    return low, high


def _space(low: float, high: float, count: int) -> Float[Tensor, "node"]:
    return torch.linspace(math.log(low), math.log(high), count, dtype=torch.float64).exp()


def _split_nuisance(
    prior: SkinPrior, f_mel: Tensor, f_blood: Tensor
) -> tuple[Nuisance, Tensor, Tensor]:
    """Return nuisance [skin, thickness], the thicknesses' shares, and the others' covariance."""
    mean, covariance, _ = prior.condition(f_mel, f_blood)
    covariance = covariance.expand(len(f_mel), 4, 4)
    x, shares = (torch.from_numpy(a) for a in np.polynomial.hermite_e.hermegauss(THICKNESSES))
    deviation = covariance[:, 0, 0].sqrt()[:, None]
    slopes = covariance[:, :, 0] / deviation
    nodes = torch.stack(list(mean), -1)[:, None] + slopes[:, None] * x[:, None]
    spread = covariance[:, 1:, 1:] - slopes[:, 1:, None] * slopes[:, None, 1:]
    return Nuisance(*nodes.unbind(-1)), shares / shares.sum(), spread


def _linearise(
    skin: FittedSkin, f_mel: Tensor, f_blood: Tensor, nuisance: Nuisance
) -> tuple[Tensor, Tensor]:
    """Return spectra, and their derivatives by every nuisance but thickness."""
    delta = 1e-4

    def expect(nuisance: Nuisance) -> Tensor:
        rest = skin.prior.leftover_mean(f_mel, nuisance, f_blood)
        return skin.predict(f_mel, f_blood, nuisance) + rest

    here = expect(nuisance)
    J = [
        (expect(nuisance._replace(**{name: value + delta})) - here) / delta
        for name, value in list(nuisance._asdict().items())[1:]
    ]
    return here, torch.stack(J, -1)
