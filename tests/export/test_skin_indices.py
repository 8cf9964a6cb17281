"""The table of indices in the package is what the physics gives."""

from pathlib import Path

import colour
import numpy as np
import pytest
import torch
from oracle import reflectance_of_one

from export.skin_indices import (
    NODES,
    TARGET,
    compute_indices,
    expect_spectra,
    main,
    sample_spectra,
    tabulate,
)
from skinnet.inference._index_table import COLUMNS, INDICES, look_up
from skinnet.inference._skin_tones import read_rows
from skinnet.physics import R_SURFACE, SkinPrior

SKINS = [(0.012, 0.02), (0.05, 0.04), (0.12, 0.06), (0.25, 0.03)]


def test_the_package_has_the_table_that_the_physics_gives() -> None:
    shipped = np.array(read_rows("skin_indices"), float)
    assert shipped.shape == (NODES[0] * NODES[1], len(COLUMNS))
    np.testing.assert_allclose(shipped, tabulate(), rtol=1e-4, atol=1e-4)
    assert TARGET.stat().st_size < 200_000


def test_between_nodes_the_table_is_within_a_tenth_of_a_degree() -> None:
    rng = np.random.default_rng(0)
    f_mel, f_blood = np.exp(rng.uniform(np.log((0.01, 0.01)), np.log((0.43, 0.15)), (300, 2))).T
    found, _ = look_up(f_mel, f_blood)
    exact = compute_indices(expect_spectra(torch.from_numpy(f_mel), torch.from_numpy(f_blood)))
    assert np.abs(found - exact).max() < 0.15 and np.abs(found - exact).mean() < 0.02


@pytest.mark.parametrize(("f_mel", "f_blood"), SKINS)
def test_colours_are_those_of_an_independent_model_and_colour_science(
    f_mel: float, f_blood: float
) -> None:
    prior, one = SkinPrior(), (torch.tensor([f_mel]).double(), torch.tensor([f_blood]).double())
    mean, _, _ = prior.condition(*one)
    skin = reflectance_of_one(f_mel, f_blood, [float(each) for each in mean])
    rest = prior.leftover_mean(one[0], mean, one[1])[0].numpy()
    spectrum = R_SURFACE + (1 - R_SURFACE) * skin + rest
    sd = colour.SpectralDistribution(spectrum, np.arange(400, 721, 10))
    with colour.utilities.suppress_warnings(colour_usage_warnings=True, python_warnings=True):
        xyz = colour.sd_to_XYZ(sd, illuminant=colour.SDS_ILLUMINANTS["D65"]) / 100
    lab = colour.XYZ_to_Lab(xyz)
    angle = np.degrees(np.arctan2(lab[0] - 50, lab[2]))
    found = dict(zip(INDICES, look_up(*(each.numpy() for each in one))[0][0], strict=True))
    assert [found[name] for name in INDICES[:3]] == pytest.approx(lab, abs=0.3)
    assert found["typology_angle"] == pytest.approx(angle, abs=0.6)


def test_spreads_are_those_of_samples_of_the_prior() -> None:
    f_mel, f_blood = (torch.tensor(each).double() for each in zip(*SKINS, strict=True))
    _, sd = look_up(f_mel.numpy(), f_blood.numpy())
    sampled = compute_indices(sample_spectra(f_mel, f_blood))
    assert sampled.shape == (4, 512, len(INDICES))
    np.testing.assert_allclose(sampled.std(1), sd, rtol=0.25)


def test_the_table_is_written_to_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("export.skin_indices.tabulate", lambda: np.arange(13.0)[None])
    main(["-o", str(tmp_path / "table.csv")])
    first, columns, row = (tmp_path / "table.csv").read_text().splitlines()
    assert first.startswith("# indices of skin") and columns == ",".join(COLUMNS)
    assert row == ",".join(map(str, range(13)))
