"""The constants of the preset `measured`, fitted to spectra with the literature as their prior."""

import math
from typing import Any, NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics import SkinOptics, SkinPrior, SkinReflectance, include_specular
from tools.joint_fit import Fit, Problem, compute_newton_step, fit_jointly, fit_own


class Constant(NamedTuple):
    """A constant that is fitted: its prior is normal, or normal in its logarithm.

    Args:
        name: Name, that of the field of `SkinOptics` where there is one.
        unit: Unit.
        mean: Prior mean; of the logarithm's distribution, exp of its mean.
        sd: Prior standard deviation; of the logarithm where `logarithmic`.
        logarithmic: Whether the logarithm is normal.
        source: Where mean and standard deviation come from.
    """

    name: str
    unit: str
    mean: float
    sd: float
    logarithmic: bool
    source: str


CONSTANTS = (
    Constant("r_surface", "1", 0.04, 0.01, False, "Fresnel at n = 1.4 to 1.5, normal to diffuse"),
    Constant("f_oxy", "fraction", 0.75, 0.1, False, "Mitsou et al. 2014"),
    Constant("r_vessel", "cm", 10e-4, 0.5, True, "capillaries and venules: 5 to 20 um"),
    Constant("d_pd", "cm", 0.2, 0.3, True, "Anderson & Parrish 1981"),
    Constant(
        "baseline", "1", 1.0, 0.1, True, "Jacques 1998: .244 + 85.3 exp(-(lambda - 154)/66.2)"
    ),
    Constant("mie", "cm^-1 nm^1.5", 2e5, 0.1, True, "Jacques 1996"),
    Constant("rayleigh", "cm^-1 nm^4", 2e12, 0.1, True, "Jacques 1996"),
    Constant("r_melanin", "cm", 5e-4, 1.0, True, "caps of melanosomes in keratinocytes of 5 um"),
)
"""What is fitted; `baseline` is the factor of `base_floor` and `base_scale`."""

CONVENTIONS = (
    "d_epd = .014 cm: f_mel and d_epd cannot be told apart. 70 um that diffuse light crosses at "
    "twice their length, so that f_mel is the literature's (light skin 1.3 to 6.3 %, moderate "
    "11 to 16 %, dark 18 to 43 %).",
    "Absorption of melanin 6.6e11 lambda^-3.33 cm^-1 (Jacques 1998), held: a free factor is d_epd, "
    "and what the data say about its slope is r_melanin.",
    "Depth and blood, d = d_pd (f_blood / .03)^1.5, only for spectra that two numbers describe: "
    "people, sites and instruments differ that way. The exponent is held near what the data take, "
    "and .03 is the blood fraction at which d = d_pd.",
)

_BASE_FLOOR, _BASE_SCALE = 0.244, 85.3
_NOISE = 0.01 * math.sqrt(8)
"""Standard deviation of a band: an error of .01 whose neighbours are correlated, so that 33 bands
count as four independent ones."""

_SET_WEIGHT = 200.0
"""Records that each set of spectra counts as."""

_LOW, _HIGH = torch.tensor([1e-3, 1e-3]).double(), torch.tensor([0.95, 0.8]).double()
"""Bounds of the square roots of f_mel and f_blood, in which the fit is nearly linear."""


def read_constants(shared: Float[Tensor, "constant"]) -> dict[str, float]:
    """Convert deviations from the prior, in its standard deviations, to constants."""
    return {
        one.name: one.mean * math.exp(one.sd * z) if one.logarithmic else one.mean + one.sd * z
        for one, z in zip(CONSTANTS, shared.tolist(), strict=True)
    }


def write_constants(constants: dict[str, float]) -> Float[Tensor, "constant"]:
    """Convert constants to deviations from the prior, in its standard deviations."""
    deviations = [
        math.log(constants[one.name] / one.mean)
        if one.logarithmic
        else constants[one.name] - one.mean
        for one in CONSTANTS
    ]
    return torch.tensor([d / one.sd for d, one in zip(deviations, CONSTANTS, strict=True)]).double()


def round_constants(constants: dict[str, float]) -> dict[str, float]:
    """Round constants to three digits, as they are typed into the preset."""
    return {name: float(f"{value:.3g}") for name, value in constants.items()}


def make_optics(constants: dict[str, float]) -> SkinOptics:
    """Make the preset `measured` with other values of what is fitted."""
    own: dict[str, Any] = dict(constants)
    factor = own.pop("baseline")
    del own["r_surface"]
    base = {"base_floor": factor * _BASE_FLOOR, "base_scale": factor * _BASE_SCALE}
    return SkinOptics.preset("measured", **own, **base)


def describe(own: Float[Tensor, "record 2"], shared: Tensor) -> Float[Tensor, "record wavelength"]:
    """Compute measured reflectance from the roots of two fractions and the constants."""
    constants = read_constants(shared)
    f_mel, f_blood = own.square().unbind(-1)
    skin = SkinReflectance(make_optics(constants), dtype=torch.float64)
    return include_specular(
        skin.bands(f_mel, f_blood, SkinPrior.typical_nuisance(f_blood)), constants["r_surface"]
    )


def make_problem(*sets: Float[Tensor, "record wavelength"]) -> Problem:
    """Weigh sets of spectra equally, whatever their number of records."""
    weight = [torch.full((len(one),), (_SET_WEIGHT / len(one)) ** 0.5) / _NOISE for one in sets]
    return Problem(describe, torch.cat(sets), torch.cat(weight).double(), _LOW, _HIGH)


def fit_constants(*sets: Float[Tensor, "record wavelength"]) -> Fit:
    """Fit the constants to sets of measured spectra, each of the same total weight."""
    problem = make_problem(*sets)
    shared = torch.zeros(len(CONSTANTS), dtype=torch.float64)
    return fit_jointly(problem, _choose_start(problem, shared), shared)


def fit_fractions(
    constants: dict[str, float], spectra: Float[Tensor, "record wavelength"]
) -> Float[Tensor, "record 2"]:
    """Fit two fractions to each spectrum, with the depth tied to blood."""
    problem, shared = make_problem(spectra), write_constants(constants)
    return fit_own(problem, _choose_start(problem, shared), shared).square()


def check_constants(
    constants: dict[str, float], *sets: Float[Tensor, "record wavelength"]
) -> Float[Tensor, "constant"]:
    """Compute the next step of a fit that starts at constants, in posterior deviations."""
    problem, shared = make_problem(*sets), write_constants(constants)
    step, deviation = compute_newton_step(problem, _choose_start(problem, shared), shared)
    return step / deviation


def _choose_start(problem: Problem, shared: Tensor) -> Float[Tensor, "record 2"]:
    nodes = torch.cartesian_prod(
        torch.linspace(0.05, 0.9, 16).double(), torch.linspace(0.05, 0.6, 10).double()
    )
    errors = problem.target[:, None] - problem.model(nodes, shared)
    return nodes[errors.nan_to_num().square().sum(-1).argmin(1)]
