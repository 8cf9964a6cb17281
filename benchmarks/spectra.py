"""How well two pigment fractions explain the measured skin of people of all tones.

`python -m benchmarks.spectra [--json] [--issa FILE] [--peers DIR]` prints root mean square errors
of reflectance, of 100 forearms (NIST) and of the faces and arms of many peoples (ISSA):

- for every preset alone; for `paper` with the vessels' radius chosen on one half of the forearms
  and scored on the other; and for forearms that `measured` recovers from their colour by two
  fractions and a scale (`median` and `p95` of `rgb`, and `rgb_...`);
- for `measured` with its prior, refitted without the half of the spectra that is scored: with two
  numbers for each spectrum (`nist`, `issa` and `groups` of `measured`; `fixed` is the preset alone,
  not refitted), from linear sRGB under D65 alone (`nist` and `issa` of `rgb`), and the share of
  fits that lie in the 90 % intervals which the colour gives (`coverage`);
- for peers on ISSA (`peers`).

`--issa FILE` adds spectra that nothing was fitted to (`held_out`). In-sample principal components
(`pca`, `pca_issa`) are the yardstick: no model with as many numbers for each spectrum has a lower
error.
"""

from collections.abc import Mapping
from pathlib import Path

import torch
from torch import Tensor

from benchmarks.bare_presets import (
    RADII,
    score_colour_alone,
    score_preset,
    score_principal_components,
    score_split_half,
)
from benchmarks.measured_skin import (
    SkinScores,
    cross_validate,
    join,
    score_skin,
    summarise_colour_alone,
    summarise_coverage,
    summarise_groups,
    summarise_two_numbers,
)
from benchmarks.peers import score_peers
from benchmarks.recovered_spectra import FittedSkin, load_d65_matrix
from benchmarks.report import Results, main
from benchmarks.skin_spectra import fill_bands, load_forearms, load_issa
from benchmarks.spectra_file import read_spectra
from skinnet.physics import PRESETS, R_SURFACE, SkinOptics, SkinPrior
from tools.fit_skin import fit_skin
from tools.prior_fit import fit_prior


def measure(
    radii: tuple[float, ...] = RADII, peers: Path | None = None, issa: Path | None = None
) -> Results:
    """Measure every figure, by name.

    Args:
        radii: Vessel radii to choose from, cm.
        peers: Checkout of a peer's code and weights; None: published figures.
        issa: File of further spectra to score, with the columns of ISSA's.
    """
    further = None if issa is None else read_spectra(issa)
    threads = torch.get_num_threads()
    # On arrays of a hundred spectra, threads wait for each other longer than they work.
    torch.set_num_threads(1)
    try:
        results = _measure(load_forearms(), load_issa(), radii, peers)
        if further is not None:
            results["held_out"] = _score_further(further)
        return results
    finally:
        torch.set_num_threads(threads)


def _measure(
    forearms: Tensor, issa: Tensor, radii: tuple[float, ...], peers: Path | None
) -> Results:
    of_peers = _score_peers(peers, issa)  # First: it may refuse the directory.
    results: Results = {preset: score_preset(preset, forearms, issa) for preset in PRESETS}
    results["split_half"] = score_split_half(forearms, radii=radii)
    results |= score_colour_alone(forearms)
    results["pca"] = score_principal_components(forearms)
    results["pca_issa"] = score_principal_components(issa)
    alone = {name: results["measured"][name] for name in ("median", "p95")}
    fixed = {"nist": alone, "issa": results["measured"]["issa"]}
    of_forearms, of_issa = cross_validate(fit_skin, forearms, issa)
    for name, found in summarise_scores({"nist": of_forearms, "issa": of_issa}).items():
        results[name] = results.get(name, {}) | found
    results["measured"]["fixed"] = fixed
    results["peers"] = of_peers
    return results


def summarise_scores(scores: Mapping[str, SkinScores]) -> Results:
    """Summarise the scores of each set of spectra, and of all sets together by group."""
    together = join(scores.values())
    return {
        "measured": {
            **{name: summarise_two_numbers(each) for name, each in scores.items()},
            "groups": summarise_groups(together),
        },
        "rgb": {name: summarise_colour_alone(each) for name, each in scores.items()},
        "coverage": summarise_coverage(together),
    }


def _score_peers(directory: Path | None, target: Tensor) -> Results:
    whole = fill_bands(target)
    return score_peers(directory, whole @ load_d65_matrix(), target)


def _score_further(target: Tensor) -> Results:
    """Score spectra that nothing was fitted to, with the constants and the prior as shipped."""
    optics = SkinOptics()
    _, reference = fit_prior(optics, R_SURFACE, load_forearms(), load_issa())
    shipped = FittedSkin(optics, R_SURFACE, SkinPrior(), SkinPrior(reference))
    found = summarise_scores({"issa": score_skin(shipped, target)})
    return {"count": len(target)} | found


if __name__ == "__main__":
    main(
        measure,
        "Errors of skin models against measured spectra.",
        paths={
            "issa": "score these spectra as well; a .csv file with the columns of ISSA's",
            "peers": "run the peers whose code and weights are in this directory",
        },
    )
