"""The fit of skin's constants: it finds what was rendered, and the preset is its result."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.optimize import least_squares

from benchmarks.skin_spectra import (
    fill_bands,
    halve_forearms,
    halve_issa,
    load_forearms,
    load_issa,
)
from skinnet.physics import R_SURFACE, SkinOptics, SkinPrior
from tools import fit_skin, skin_constants
from tools.joint_fit import Problem, fit_jointly
from tools.prior_fit import fit_prior
from tools.skin_constants import (
    CONSTANTS,
    check_constants,
    describe,
    fit_constants,
    fit_fractions,
    make_optics,
    read_constants,
    round_constants,
    write_constants,
)

_BASE = {"base_floor": 0.244, "base_scale": 85.3}


@pytest.fixture(scope="module")
def shipped() -> dict[str, float]:
    optics = SkinOptics()
    names = ("f_oxy", "r_vessel", "d_pd", "mie", "rayleigh", "r_melanin")
    constants = {name: float(getattr(optics, name)) for name in names}
    factor = float(optics.base_scale) / _BASE["base_scale"]
    return constants | {"r_surface": R_SURFACE, "baseline": factor}


def test_the_preset_is_the_minimum(shipped: dict[str, float]) -> None:
    # Rounded to two or three digits, it lies within a small part of the posterior deviation.
    step = check_constants(shipped, load_forearms(), load_issa())
    assert step.abs().max() < 0.1


def test_the_preset_is_the_scripts_output(shipped: dict[str, float]) -> None:
    fitted = round_constants(read_constants(fit_constants(load_forearms(), load_issa()).shared))
    for name, value in fitted.items():
        assert shipped[name] == pytest.approx(value, rel=0.01), name
    assert float(SkinOptics().base_floor) == pytest.approx(fitted["baseline"] * 0.244, rel=0.01)


def test_the_prior_is_the_scripts_output() -> None:
    record, _ = fit_prior(SkinOptics(), R_SURFACE, load_forearms(), load_issa())
    found, expected = SkinPrior(), SkinPrior(record)
    for name in ("weights", "means", "covariances", "coefficients", "nuisance", "leftover_means"):
        ours, theirs = getattr(found, name), getattr(expected, name)
        torch.testing.assert_close(ours, theirs, rtol=0.02, atol=2e-3)
    torch.testing.assert_close(found.leftover, expected.leftover, rtol=0.02, atol=2e-6)


def test_constants_convert_to_deviations_and_back(shipped: dict[str, float]) -> None:
    assert read_constants(write_constants(shipped)) == pytest.approx(shipped)
    assert read_constants(torch.zeros(len(CONSTANTS))) == pytest.approx(
        {one.name: one.mean for one in CONSTANTS}
    )
    optics = make_optics(shipped)
    assert optics.base_scale == pytest.approx(float(SkinOptics().base_scale))
    assert optics.r_melanin == SkinOptics().r_melanin and optics.d_epd == SkinOptics().d_epd


def test_rendered_constants_are_found() -> None:
    truth = torch.tensor([0.5, -0.5, -0.5, 0.3, 0.4, -0.3, 0.2, 0.3]).double()
    rng = torch.Generator().manual_seed(0)
    roots = torch.rand(120, 2, generator=rng, dtype=torch.float64)
    roots = roots * torch.tensor([0.4, 0.15]) + torch.tensor([0.15, 0.13])
    spectra = describe(roots, truth)
    spectra[::3, -2:] = float("nan")
    fit = fit_constants(spectra[:60], spectra[60:])
    # The prior draws what the spectra say little about towards zero.
    error = (describe(fit.own, fit.shared) - spectra).square().nanmean().sqrt()
    assert error < 3e-4 and (fit.shared - truth).abs().max() < 0.5
    assert (fit.own - roots).abs().max() < 0.03


def test_fractions_are_found_for_given_constants(shipped: dict[str, float]) -> None:
    roots = torch.tensor([[0.2, 0.2], [0.5, 0.15], [0.35, 0.25]], dtype=torch.float64)
    spectra = describe(roots, write_constants(shipped))
    torch.testing.assert_close(fit_fractions(shipped, spectra), roots.square())


def test_joint_fit_agrees_with_scipy() -> None:
    rng = np.random.default_rng(0)
    x = torch.linspace(0, 1, 12, dtype=torch.float64)
    truth = torch.from_numpy(rng.uniform(0.5, 1.5, (5, 1)))

    def model(own: torch.Tensor, shared: torch.Tensor) -> torch.Tensor:
        return own * torch.exp(-shared[0] * x) + 0.3 * shared[1]

    target = model(truth, torch.tensor([1.0, -0.5])) + 0.05 * torch.from_numpy(
        rng.normal(size=(5, 12))
    )
    bound = torch.tensor([10.0]).double()
    problem = Problem(model, target, torch.full((5,), 20.0).double(), -bound, bound)
    fit = fit_jointly(problem, torch.ones(5, 1).double(), torch.zeros(2).double())

    def residuals(values: np.ndarray) -> np.ndarray:
        own, shared = torch.from_numpy(values[:5, None]), torch.from_numpy(values[5:])
        return np.r_[problem.compute_residuals(own, shared).numpy().ravel(), values[5:]]

    found = least_squares(residuals, np.r_[np.ones(5), np.zeros(2)], xtol=1e-12, ftol=1e-12)
    assert fit.shared.numpy() == pytest.approx(found.x[5:], abs=1e-5)
    covariance = np.linalg.inv(found.jac.T @ found.jac)[5:, 5:]
    assert fit.covariance.numpy() == pytest.approx(covariance, rel=1e-3, abs=1e-7)


def test_spectra_equal_the_shared_file(shared_data: Path) -> None:
    ours = (Path(fit_skin.__file__).parents[1] / "benchmarks/data/issa_train.csv").read_text()
    assert ours.startswith("# ") and "CC BY 4.0" in ours.splitlines()[0]
    assert ours.split("\n", 1)[1] == (shared_data / "spectra" / "issa_train.csv").read_text()


def test_spectra_have_their_shapes_and_halves() -> None:
    forearms, issa = load_forearms(), load_issa()
    assert forearms.shape == (100, 33) and not forearms.isnan().any()
    assert issa.shape == (348, 33) and issa.isnan().sum() == 237 * 2
    assert not fill_bands(issa).isnan().any()
    for (ours, theirs), count in ((halve_forearms(), 100), (halve_issa(), 348)):
        assert sorted([*ours.tolist(), *theirs.tolist()]) == list(range(count))


def test_every_constant_is_printed_with_its_prior(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    fit = fit_constants(load_forearms()[:10], load_issa()[::35])
    monkeypatch.setattr(fit_skin, "fit_constants", lambda *_: fit)
    fit_skin.main([])
    text = capsys.readouterr().out
    assert all(one.name in text and one.source in text for one in CONSTANTS)
    assert "Convention, not data" in text and "d_epd" in text
    fit_skin.main(["--json"])
    rows = json.loads(capsys.readouterr().out)["constants"]
    assert [row["name"] for row in rows] == [one.name for one in CONSTANTS]
    for row in rows:
        assert row["unit"] and row["source"] and 0 < row["sd_ratio"] <= 1
        back = skin_constants.read_constants(torch.tensor([one["shift"] for one in rows]))
        assert row["exact"] == pytest.approx(back[row["name"]], rel=1e-5)


def test_the_prior_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit_skin, "PRIOR_FILE", tmp_path / "prior.json")
    monkeypatch.setattr(fit_skin, "fit_prior", lambda *_: ({"a": [1.234567e-7, 0.0]}, {}))
    fit_skin.main(["--write", "--json"])
    assert json.loads((tmp_path / "prior.json").read_text()) == {"a": [1.2346e-7, 0.0]}
