"""Scores of the preset `measured` and of `SkinPrior` on spectra that neither was fitted to."""

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.colour_differences import (
    LIGHTS,
    compute_differences,
    compute_typology_angles,
)
from benchmarks.least_squares import compute_rmse, fit, summarise
from benchmarks.recovered_spectra import (
    ColourPosterior,
    FittedSkin,
    SkinNodes,
    compute_interval,
    load_d65_matrix,
    make_exact,
)
from benchmarks.report import Results
from benchmarks.skin_spectra import fill_bands, halve_forearms, halve_issa
from benchmarks.typology import GROUPS, find_group
from benchmarks.whole_spectra import SkinFit, fit_skins

Refit = Callable[[Tensor, Tensor], FittedSkin]
"""Fits constants and prior to spectra of forearms and of ISSA."""

BOUNDS = ((0.0, 0.6), (1e-3, 0.3))
"""Bounds of f_mel and f_blood; where depth follows blood, skin without blood has no depth."""


class SkinScores(NamedTuple):
    """What is measured of each spectrum.

    Attributes:
        angle: Individual typology angle, degrees.
        rmse: Error of the fit of two numbers.
        fractions: f_mel and f_blood of that fit.
        rgb_rmse: Error of the spectrum that is recovered from its colour.
        delta_e: CIEDE2000 of that spectrum, once its colour under D65 is exact.
        delta_e_uncorrected: The same without the correction.
        inside: Whether the fit of melanin, blood and nuisance lies in the colour's 90 % interval.
    """

    angle: Float[Tensor, "people"]
    rmse: Float[Tensor, "people"]
    fractions: Float[Tensor, "people 2"]
    rgb_rmse: Float[Tensor, "people"]
    delta_e: Float[Tensor, "people light"]
    delta_e_uncorrected: Float[Tensor, "people light"]
    inside: Float[Tensor, "people 2"]


def score_skin(skin: FittedSkin, target: Float[Tensor, "people wavelength"]) -> SkinScores:
    """Score what was fitted on other spectra; bands that are NaN are missing."""
    rmse, fractions = score_two_numbers(skin, target)
    whole = fill_bands(target)
    nodes, rgb = SkinNodes(skin), whole @ load_d65_matrix()
    posterior = nodes.infer(rgb)
    return SkinScores(
        angle=compute_typology_angles(whole),
        rmse=rmse,
        fractions=fractions,
        rgb_rmse=compute_rmse(posterior.spectra, target),
        delta_e=compute_differences(make_exact(posterior.spectra, rgb), whole),
        delta_e_uncorrected=compute_differences(posterior.spectra, whole),
        inside=_score_intervals(nodes, posterior, _fit_whole(skin, target)),
    )


def _fit_whole(skin: FittedSkin, target: Tensor) -> SkinFit:
    return fit_skins(skin._replace(prior=skin.reference or skin.prior), target)


def _score_intervals(
    nodes: SkinNodes, posterior: ColourPosterior, best: SkinFit
) -> Float[Tensor, "people 2"]:
    """Return 1 for each fit of melanin and blood that lies in the colour's interval, else 0."""
    axes = ((nodes.f_mel, posterior.f_mel), (nodes.f_blood, posterior.f_blood))
    inside = []
    for i, (node, weights) in enumerate(axes):
        low, high = compute_interval(node, weights)
        f = best.skins[:, i].exp()
        inside.append(((low <= f) & (f <= high)).double())
    return torch.stack(inside, -1)


def score_two_numbers(skin: FittedSkin, target: Tensor) -> tuple[Tensor, Tensor]:
    """Fit melanin and blood where depth follows blood; return errors and fractions."""

    def model(f_mel: Tensor, f_blood: Tensor) -> Tensor:
        return skin.predict(f_mel, f_blood, skin.prior.typical_nuisance(f_blood))

    fractions = fit(model, target, BOUNDS)
    return compute_rmse(model(*fractions.T), target), fractions


def cross_validate(
    refit: Refit,
    forearms: Float[Tensor, "people wavelength"],
    issa: Float[Tensor, "record wavelength"],
) -> tuple[SkinScores, SkinScores]:
    """Score each half of both sets with what is fitted to the other halves.

    Forearms are halved at random, one person each; ISSA by alternating blocks of neighbouring
    records, because one person may have several.
    """
    people, records = halve_forearms(), halve_issa()
    scores = []
    for ours, theirs in ((0, 1), (1, 0)):
        skin = refit(forearms[people[ours]], issa[records[ours]])
        scores.append(
            (score_skin(skin, forearms[people[theirs]]), score_skin(skin, issa[records[theirs]]))
        )
    first, second = zip(*scores, strict=True)
    return join(first), join(second)


def join(scores: Iterable[SkinScores]) -> SkinScores:
    """Join the scores of several sets of spectra."""
    return SkinScores(*(torch.cat(values) for values in zip(*scores, strict=True)))


def summarise_two_numbers(scores: SkinScores) -> Results:
    """Summarise the fits of two numbers, for all and by group."""
    return _summarise_fits(scores) | {"groups": summarise_groups(scores)}


def _summarise_fits(scores: SkinScores) -> Results:
    f_mel, f_blood = scores.fractions.quantile(0.5, dim=0).tolist()
    return summarise(scores.rmse) | {"f_mel": f_mel, "f_blood": f_blood}


def summarise_colour_alone(scores: SkinScores) -> Results:
    """Summarise what is recovered from colour alone."""
    return summarise(scores.rgb_rmse) | {
        "delta_e": _name_lights(scores.delta_e),
        "delta_e_uncorrected": _name_lights(scores.delta_e_uncorrected),
    }


def _name_lights(differences: Tensor) -> Results:
    return dict(zip(LIGHTS, differences.quantile(0.5, dim=0).tolist(), strict=True))


def summarise_groups(scores: SkinScores) -> Results:
    """Summarise the fits of two numbers by the group of the typology angle."""
    return {
        name: {"count": len(part.angle)} | _summarise_fits(part)
        for name, part in _split_groups(scores)
    }


def summarise_coverage(scores: SkinScores) -> Results:
    """Summarise by group the share of fits that lie in the 90 % intervals of their colours."""
    coverage: Results = {}
    for name, part in _split_groups(scores):
        f_mel, f_blood = part.inside.mean(0).tolist()
        coverage[name] = {"count": len(part.angle), "f_mel": f_mel, "f_blood": f_blood}
    return coverage


def _split_groups(scores: SkinScores) -> Iterator[tuple[str, SkinScores]]:
    names = [find_group(angle) for angle in scores.angle.tolist()]
    for name in GROUPS:
        mask = torch.tensor([name == other for other in names])
        if mask.any():
            yield name, SkinScores(*(values[mask] for values in scores))
