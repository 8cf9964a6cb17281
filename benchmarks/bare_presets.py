"""Presets alone on measured spectra, without nuisance or prior, and the least possible errors."""

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.least_squares import BOUNDS, Bounds, compute_rmse, fit, summarise
from benchmarks.recovered_spectra import load_d65_matrix
from benchmarks.report import Results
from skinnet.physics import R_SURFACE, SkinOptics, SkinReflectance, include_specular

PAPER_RANGE = ((0.01, 0.43), (0.02, 0.07))
RADII = tuple(step * 2.5e-4 for step in range(17))
"""Vessel radii to choose from, 0 to 40 um, in cm."""

SEED, SPLITS = 0, 50
SCALES = (0.25, 2.0)
STIFFNESS = 0.3
"""Weight of the scale against colour: an error of 7 % in scale costs as much as .02 in colour."""


def score_preset(preset: str, forearms: Tensor, issa: Tensor) -> Results:
    """Score a preset on forearms, also within the paper's range of fractions, and on ISSA.

    `measured` is compared as instruments see it, with the reflection at the surface.
    """
    r_surface = R_SURFACE if preset == "measured" else 0.0
    inside = compute_fit_rmse(preset, forearms, PAPER_RANGE, r_surface)
    return {
        **summarise(compute_fit_rmse(preset, forearms, r_surface=r_surface)),
        "paper_range_median": inside.quantile(0.5).item(),
        "issa": summarise(compute_fit_rmse(preset, issa, r_surface=r_surface)),
    }


def compute_fit_rmse(
    optics: SkinOptics | str, target: Tensor, bounds: Bounds = BOUNDS, r_surface: float = 0.0
) -> Float[Tensor, "people"]:
    """Compute the error of each spectrum's best fit by two fractions."""
    bands = SkinReflectance(optics, dtype=torch.float64).bands

    def model(f_mel: Tensor, f_blood: Tensor) -> Tensor:
        return include_specular(bands(f_mel, f_blood), r_surface)

    return compute_rmse(model(*fit(model, target, bounds).T), target)


def score_split_half(target: Tensor, radii: tuple[float, ...], splits: int = SPLITS) -> Results:
    """Choose the radius on one half of the people and score it on the other half."""
    errors = torch.stack(
        [compute_fit_rmse(SkinOptics.preset("paper", r_vessel=r), target) for r in radii]
    )
    rng = torch.Generator().manual_seed(SEED)
    chosen, held_out = [], []
    for _ in range(splits):
        order = torch.randperm(len(target), generator=rng)
        ours, theirs = order.chunk(2)
        best = int(errors[:, ours].quantile(0.5, dim=1).argmin())
        chosen.append(best)
        held_out.append(errors[best, theirs])
    scores = torch.stack(held_out)
    return {
        "median": scores.quantile(0.5, dim=1).mean().item(),
        "mean": scores.mean().item(),
        "worst_median": scores.quantile(0.5, dim=1).max().item(),
        "r_um": {f"{radii[i] * 1e4:g}": chosen.count(i) for i in sorted(set(chosen))},
        "splits": splits,
        "seed": SEED,
    }


def recover_from_rgb(
    rgb: Float[Tensor, "people 3"], stiffness: float = 0.0
) -> Float[Tensor, "people wavelength"]:
    """Recover spectra from linear sRGB alone, by two fractions and a scale.

    With no stiffness, three numbers are fitted to three: the fractions to the two chromaticities,
    and then the scale. With stiffness, |s model - rgb|^2 + stiffness^2 (s - 1)^2 is minimised: the
    scale of a reflectance is known, so a scale far from one means that the colour is off the model.
    """
    matrix, bands = load_d65_matrix(), SkinReflectance(dtype=torch.float64).bands

    def colours(f_mel: Tensor, f_blood: Tensor, scale: Tensor) -> Tensor:
        colour = scale[:, None] * (bands(f_mel, f_blood) @ matrix)
        return torch.cat([colour, stiffness * scale[:, None]], -1)

    target = torch.cat([rgb, torch.full_like(rgb[:, :1], stiffness)], -1)
    f_mel, f_blood, scale = fit(colours, target, (*BOUNDS, SCALES)).T
    return scale[:, None] * bands(f_mel, f_blood)


def rescale(recovered: Tensor, target: Tensor) -> Float[Tensor, "people wavelength"]:
    """Scale each recovered spectrum to the measured one."""
    scale = (recovered * target).sum(-1) / recovered.square().sum(-1)
    return scale[:, None] * recovered


def score_principal_components(target: Tensor) -> Results:
    """Compute the median in-sample error of one, two and three components, the least possible.

    Bands that were not measured for all are left out.
    """
    target = target[:, ~target.isnan().any(0)]
    mean = target.mean(0)
    _, _, V = torch.linalg.svd(target - mean, full_matrices=False)
    projections = {n: mean + (target - mean) @ V[:n].T @ V[:n] for n in (1, 2, 3)}
    return {str(n): summarise(compute_rmse(p, target))["median"] for n, p in projections.items()}


def score_colour_alone(target: Tensor) -> Results:
    """Score spectra that are recovered from linear sRGB under D65.

    `rgb` fits fractions and scale to the colour alone. `rgb_up_to_scale` is given the scale of the
    measured spectrum, as for a photograph whose exposure is known. `rgb_scale_near_one` penalises a
    scale far from one.
    """
    rgb = target @ load_d65_matrix()
    free, stiff = recover_from_rgb(rgb), recover_from_rgb(rgb, STIFFNESS)
    return {
        "rgb": summarise(compute_rmse(free, target)),
        "rgb_up_to_scale": summarise(compute_rmse(rescale(free, target), target)),
        "rgb_scale_near_one": summarise(compute_rmse(stiff, target)),
    }
