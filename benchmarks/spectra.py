"""How well two pigment fractions explain the measured skin of 100 people.

`python -m benchmarks.spectra [--json]` prints root mean square errors of reflectance at 33 bands:
for every preset; with the vessels' radius chosen on one half of the people and scored on the other;
and for spectra that are recovered from their colour under D65 alone. In-sample principal components
are the yardstick: no model with as many numbers for each spectrum has a lower error.
"""

from collections.abc import Callable
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.report import Results, main
from skinnet.physics import (
    PRESETS,
    SkinOptics,
    SkinReflectance,
    load_light,
    load_observer,
    spectrum_to_srgb,
)

Model = Callable[[Tensor, Tensor], Tensor]

BOUNDS = ((0.0, 0.6), (0.0, 0.3))
"""Bounds of f_mel and f_blood, wider than any skin."""

PAPER_RANGE = ((0.01, 0.43), (0.02, 0.07))
RADII = tuple(step * 2.5e-4 for step in range(17))
"""Vessel radii to choose from, 0 to 40 um, in cm."""

SEED, SPLITS = 0, 50
SCALES = (0.25, 2.0)
STIFFNESS = 0.3
"""Weight of the scale against colour: an error of 7 % in scale costs as much as .02 in colour."""


def load_forearms() -> Float[Tensor, "people wavelength"]:
    """Load the reflectance of the inner forearm of 100 people (NIST, doi 10.18434/M38597)."""
    text = (Path(__file__).parent / "data" / "nist_forearm_100.csv").read_text(encoding="utf-8")
    rows = [line.split(",") for line in text.splitlines()[2:]]
    return torch.tensor([[float(value) for value in row[1:]] for row in rows]).double().T


def fit(
    model: Model,
    target: Float[Tensor, "people value"],
    bounds: tuple[tuple[float, float], ...] = BOUNDS,
) -> Float[Tensor, "people parameter"]:
    """Fit the parameters of a model to each target, within bounds.

    Levenberg and Marquardt's steps, for all people at once, start at the best point of a coarse
    grid. A parameter that leaves its bounds is clipped, and is held in the step that follows.
    """
    low, high = torch.tensor(bounds, dtype=torch.float64).T
    f = _choose_start(model, target, low, high)
    damping = torch.full((len(target),), 1e-3, dtype=torch.float64)
    error = (model(*f.T) - target).square().sum(-1)
    for _ in range(30):
        trial = (f + _compute_step(model, f, target, damping, low, high)).clamp(low, high)
        tried = (model(*trial.T) - target).square().sum(-1)
        better = tried < error
        if (trial - f).abs().max() < 1e-8:
            break
        f, error = torch.where(better[:, None], trial, f), torch.where(better, tried, error)
        damping = torch.where(better, damping / 5, damping * 5).clamp(1e-12, 1e12)
    return f


def _choose_start(model: Model, target: Tensor, low: Tensor, high: Tensor) -> Tensor:
    # Spaced as u^2: the colour changes fastest where a fraction is small.
    axes = [
        a + (b - a) * torch.linspace(0, 1, 40).double() ** 2 for a, b in zip(low, high, strict=True)
    ]
    nodes = torch.cartesian_prod(*axes)
    return nodes[torch.cdist(target, model(*nodes.T)).argmin(1)]


def _compute_step(
    model: Model, f: Tensor, target: Tensor, damping: Tensor, low: Tensor, high: Tensor
) -> Tensor:
    unit = torch.eye(len(low), dtype=torch.float64)
    here, delta = model(*f.T), 1e-6
    # Finite differences: forward-mode differentiation of such small arrays takes ten times longer.
    J = torch.stack([(model(*(f + delta * e).T) - here) / delta for e in unit], -1)
    residual = target - here
    gradient = (J.mT @ residual[..., None])[..., 0]
    held = ((f <= low) & (gradient < 0)) | ((f >= high) & (gradient > 0))
    J = J * ~held[:, None, :]
    normal = J.mT @ J
    ridge = damping[:, None] * normal.diagonal(dim1=-2, dim2=-1) + held + 1e-15
    return torch.linalg.solve(normal + torch.diag_embed(ridge), gradient * ~held)


def compute_rmse(recovered: Tensor, target: Tensor) -> Float[Tensor, "people"]:
    """Compute the root mean square error of each spectrum."""
    return (recovered - target).square().mean(-1).sqrt()


def compute_fit_rmse(
    optics: SkinOptics | str, target: Tensor, bounds: tuple[tuple[float, float], ...] = BOUNDS
) -> Float[Tensor, "people"]:
    """Compute the error of each spectrum's best fit."""
    model = SkinReflectance(optics, dtype=torch.float64).bands
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


def load_d65_matrix() -> Float[Tensor, "wavelength 3"]:
    """Load the spectrum-to-sRGB matrix of D65, with the standard observer as the camera."""
    return spectrum_to_srgb(load_light("D6504K"), load_observer(), load_observer())


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


def score_principal_components(target: Tensor, count: int) -> Float[Tensor, "people"]:
    """Compute the in-sample error of `count` principal components, the least that is possible."""
    mean = target.mean(0)
    _, _, V = torch.linalg.svd(target - mean, full_matrices=False)
    return compute_rmse(mean + (target - mean) @ V[:count].T @ V[:count], target)


def measure(radii: tuple[float, ...] = RADII) -> Results:
    """Measure every figure, by name."""
    threads = torch.get_num_threads()
    # On arrays of a hundred spectra, threads wait for each other longer than they work.
    torch.set_num_threads(1)
    try:
        return _measure(load_forearms(), radii)
    finally:
        torch.set_num_threads(threads)


def _measure(target: Tensor, radii: tuple[float, ...]) -> Results:
    results: Results = {}
    for preset in PRESETS:
        results[preset] = _compute_quantiles(compute_fit_rmse(preset, target))
        inside = _compute_quantiles(compute_fit_rmse(preset, target, PAPER_RANGE))["median"]
        results[preset]["paper_range_median"] = inside
    results["split_half"] = score_split_half(target, radii=radii)
    results |= score_colour_alone(target)
    results["pca"] = {
        str(n): _compute_quantiles(score_principal_components(target, n))["median"]
        for n in (1, 2, 3)
    }
    return results


def score_colour_alone(target: Tensor) -> Results:
    """Score spectra that are recovered from linear sRGB under D65.

    `rgb` fits fractions and scale to the colour alone. `rgb_up_to_scale` is given the scale of the
    measured spectrum, as for a photograph whose exposure is known. `rgb_scale_near_one` penalises a
    scale far from one.
    """
    rgb = target @ load_d65_matrix()
    free, stiff = recover_from_rgb(rgb), recover_from_rgb(rgb, STIFFNESS)
    return {
        "rgb": _compute_quantiles(compute_rmse(free, target)),
        "rgb_up_to_scale": _compute_quantiles(compute_rmse(rescale(free, target), target)),
        "rgb_scale_near_one": _compute_quantiles(compute_rmse(stiff, target)),
    }


def _compute_quantiles(errors: Tensor) -> Results:
    return {"median": errors.quantile(0.5).item(), "p95": errors.quantile(0.95).item()}


if __name__ == "__main__":
    main(measure, "Errors of two-parameter skin against 100 measured spectra.")
