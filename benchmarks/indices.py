"""How near indices from two pigment fractions are to those of the spectrum itself.

`python -m benchmarks.indices [--json]` fits melanin, blood and nuisance to the spectra of 100
forearms (NIST) and of 348 faces and arms (ISSA), keeps the two fractions, and compares the indices
that `skinnet predict` computes from them with those of the spectrum. L*a*b* and typology angle of
the spectrum are colour-science's.

For each of `nist`, `issa` and `all`, and each index, it prints the median and the 90th percentile
of the absolute error, the mean error (`bias`), and the share of spectra whose own index lies in the
90 % interval that the fractions give if they are known exactly (`coverage`). `held_out` has the
same where the distribution of skins is fitted to the other half of the spectra. `monk_tone` has the
share of spectra with the same nearest tone, with one that is at most one tone off, and how many
spectra have which tone.
"""

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.colour_differences import compute_lab
from benchmarks.recovered_spectra import FittedSkin
from benchmarks.report import Results, main
from benchmarks.skin_spectra import (
    fill_bands,
    halve_forearms,
    halve_issa,
    load_forearms,
    load_issa,
)
from benchmarks.whole_spectra import fit_skins
from export.skin_indices import compute_indices, expect_spectra, sample_spectra
from skinnet.inference._index_definitions import (
    compute_erythema_index,
    compute_melanin_index,
    compute_typology_angle,
)
from skinnet.inference._index_table import INDICES, look_up
from skinnet.inference._skin_tones import compare_with_monk
from skinnet.physics import R_SURFACE, SkinOptics, SkinPrior
from tools.prior_fit import fit_prior

FACTOR = 1.6449
"""Standard deviations on either side of a 90 % interval."""

Array = NDArray[np.float64]
Predict = Callable[[Tensor, Tensor], tuple[Array, Array]]
"""From both fractions to `INDICES` and their standard deviations."""


def measure() -> Results:
    """Measure every figure, by name."""
    forearms, issa = load_forearms(), load_issa()
    threads = torch.get_num_threads()
    # On arrays of a hundred spectra, threads wait for each other longer than they work.
    torch.set_num_threads(1)
    try:
        _, reference = fit_prior(SkinOptics(), R_SURFACE, forearms, issa)
        skin = FittedSkin(SkinOptics(), R_SURFACE, SkinPrior(reference))
        scores = {
            name: score(skin, spectra, _look_up)
            for name, spectra in (("nist", forearms), ("issa", issa))
        }
        held_out = _score_held_out(forearms, issa)
    finally:
        torch.set_num_threads(threads)
    return _summarise_sets(scores) | {"held_out": _summarise_sets(held_out)}


def score(skin: FittedSkin, spectra: Tensor, predict: Predict) -> Array:
    """Score indices from the pigments that fit spectra best.

    Returns:
        The spectra's own indices, those from pigments, and the latter's standard deviations
        [3, people, 6].
    """
    f_mel, f_blood = fit_skins(skin, spectra).skins[:, :2].exp().unbind(-1)
    return np.stack([_compute_own(spectra), *predict(f_mel, f_blood)])


def _compute_own(spectra: Tensor) -> Array:
    lab, whole = compute_lab(spectra).numpy(), fill_bands(spectra).numpy()
    others = (compute_melanin_index(whole), compute_erythema_index(whole))
    return np.stack([*lab.T, compute_typology_angle(lab), *others], -1)


def _look_up(f_mel: Tensor, f_blood: Tensor) -> tuple[Array, Array]:
    return look_up(f_mel.numpy(), f_blood.numpy())


def _score_held_out(forearms: Tensor, issa: Tensor) -> dict[str, Array]:
    people, records = halve_forearms(), halve_issa()
    found: dict[str, list[Array]] = {"nist": [], "issa": []}
    for ours, theirs in ((0, 1), (1, 0)):
        record, reference = fit_prior(
            SkinOptics(), R_SURFACE, forearms[people[ours]], issa[records[ours]]
        )
        skin = FittedSkin(SkinOptics(), R_SURFACE, SkinPrior(reference))
        predict = _make_prediction(SkinPrior(record))
        found["nist"].append(score(skin, forearms[people[theirs]], predict))
        found["issa"].append(score(skin, issa[records[theirs]], predict))
    return {name: np.concatenate(halves, 1) for name, halves in found.items()}


def _make_prediction(prior: SkinPrior) -> Predict:
    """Make what the table of the package does for another prior."""

    def predict(f_mel: Tensor, f_blood: Tensor) -> tuple[Array, Array]:
        indices = compute_indices(expect_spectra(f_mel, f_blood, prior))
        sampled = compute_indices(sample_spectra(f_mel, f_blood, prior))
        return indices, np.sqrt(np.mean((sampled - indices[:, None]) ** 2, 1))

    return predict


def _summarise_sets(scores: dict[str, Array]) -> Results:
    scores = scores | {"all": np.concatenate(list(scores.values()), 1)}
    return {name: _summarise(each) for name, each in scores.items()}


def _summarise(scores: Array) -> Results:
    own, found, sd = scores
    error = found - own
    results: Results = {"count": len(own)}
    for name, e, covered in zip(INDICES, error.T, (abs(error) < FACTOR * sd).T, strict=True):
        results[name] = {
            "median": float(np.median(abs(e))),
            "p90": float(np.quantile(abs(e), 0.9)),
            "bias": float(e.mean()),
            "coverage": float(covered.mean()),
        }
    return results | {"monk_tone": _compare_tones(own[:, :3], found[:, :3])}


def _compare_tones(own: Array, found: Array) -> Results:
    true, read = (compare_with_monk(lab).argmin(-1) + 1 for lab in (own, found))
    off = abs(true - read)
    counts = {str(tone): int((true == tone).sum()) for tone in range(1, 11)}
    return {"same": float((off == 0).mean()), "near": float((off <= 1).mean()), "counts": counts}


if __name__ == "__main__":
    main(measure, "Errors of indices that are computed from pigments against those of spectra.")
