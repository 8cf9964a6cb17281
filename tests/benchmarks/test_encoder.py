"""The encoder's benchmark: its contract, its measures, and its baselines where they must work."""

import json
from pathlib import Path
from typing import Any

import colour
import numpy as np
import pytest
import torch
from PIL import Image
from skimage.data import astronaut

from benchmarks import disturbances, encoder, portraits, targets
from benchmarks.baselines import Lookup, Tsumura
from benchmarks.coverage import Coverage
from benchmarks.pictures import Pictures, Pixels, render_under_daylight
from benchmarks.reader import NetworkReader, compose
from benchmarks.running_statistics import RunningStatistics
from benchmarks.scores import Scores
from benchmarks.typology import GROUPS, compute_typology_angle, find_group
from skinnet.network.autoencoder import AutoencoderConfig, SkinAutoencoder, SkinMaps
from skinnet.physics import SkinDecoder, SpectralCamera

PIGMENT = {"rmse", "rmse_ratio", "r_pixel", "r_image", "grid_rmse"}
COLUMNS = {"diffuse", "specular", "albedo", "reconstruction", "mask_iou", "leak", "group_ratio"}
TINY = {
    **{"size": 32, "heads": 2, "samples": 4, "train_size": 32, "train_heads": 1},
    **{"train_samples": 2, "ict": None, "batch_size": 2, "portraits": "nowhere"},
}


@pytest.fixture(scope="module")
def model() -> SkinAutoencoder:
    torch.manual_seed(0)
    return SkinAutoencoder(AutoencoderConfig(widths=(4, 8), working_size=32)).eval()


@pytest.fixture(scope="module")
def found(model: SkinAutoencoder, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    geometry = tmp_path_factory.mktemp("geometry")
    return encoder.measure(
        encoder.TestSet(**TINY, optics=model.config.optics, geometry=str(geometry)),
        {"stage2": model, "fourth": model},
    )


def test_shipped_and_fourth_are_measured_in_each_kind_of_captures(found: dict[str, Any]) -> None:
    for row in ("wide", "known", "mild", "any"):
        own = {"blind"} if row == "mild" else set()
        intervals = {"coverage", "coverage_pixels", "stated_sd"}
        assert set(found[row]) == {"melanin", "hemoglobin", *COLUMNS, *intervals, *own}
        assert 0 <= found[row]["coverage"]["melanin"]["all"] <= 1
        assert set(found[row]["coverage"]["hemoglobin"]["groups"]) <= set(GROUPS)
    assert found["mild"]["blind"]["melanin"] == found["stage2"]["melanin"]
    assert found["wide"]["melanin"] != found["known"]["melanin"]
    assert set(found["fourth"]) == {"wide", "mild"}
    assert set(found["fourth"]["wide"]) == {"melanin", "hemoglobin", "mask_iou"}


def test_coverage_counts_what_lies_inside(skins: Pictures) -> None:
    rng = torch.Generator().manual_seed(0)
    melanin, hemoglobin = (
        value * (0.2 * torch.randn(len(value), generator=rng)).exp() for value in skins.truth[:2]
    )
    guess = skins.truth._replace(
        melanin=melanin,
        hemoglobin=hemoglobin,
        sd=torch.full((len(melanin), 2), 0.2) * torch.tensor([1.0, 1e-3]),
        face_sd=torch.tensor([[1.0, 1e-9]]).expand(6, 2),
    )
    coverage = Coverage()
    coverage.add(skins.truth, skins)
    coverage.add(guess, skins)
    found = coverage.compute_results()
    assert found["coverage"]["melanin"]["all"] == 1 and found["coverage"]["hemoglobin"]["all"] == 0
    assert found["coverage_pixels"]["melanin"]["all"] == pytest.approx(0.9, abs=0.08)
    assert found["coverage_pixels"]["hemoglobin"]["all"] < 0.05
    assert list(found["coverage"]["melanin"]["groups"]) == [
        name for name in GROUPS if name in {find_group(angle) for angle in skins.angle.tolist()}
    ]


@pytest.fixture(scope="module")
def skins() -> Pictures:
    """Six even skins, ever darker, without shading or specular reflection, in their true colour."""
    melanin = torch.logspace(-1.9, -0.6, 6).repeat_interleave(16)
    hemoglobin = torch.full_like(melanin, 0.04)
    albedo = render_under_daylight(melanin, hemoglobin, SkinDecoder())
    one = torch.ones_like(melanin)
    mask = torch.ones(6, 4, 4, dtype=torch.bool)
    truth = Pixels(melanin, hemoglobin, one, 0 * one, albedo, albedo, mask)
    angle = compute_typology_angle(albedo[::16])
    return Pictures(np.zeros((6, 4, 4, 3), np.uint8), truth, mask.nonzero()[:, 0], angle)


def test_results_have_the_agreed_keys(found: dict[str, Any]) -> None:
    for row in ("constant", "lookup", "ica", "stage2"):
        assert set(found[row]) == {"melanin", "hemoglobin", *COLUMNS}
        assert set(found[row]["melanin"]) == set(found[row]["hemoglobin"]) == PIGMENT
    assert found["stage1"] is None and found["portraits"] is None
    assert found["constant"]["melanin"]["rmse_ratio"] == 1
    assert found["constant"]["melanin"]["r_pixel"] is None
    assert all(value is not None for _, value in targets.flatten(found["stage2"]))
    assert json.loads(json.dumps(found, allow_nan=False))["settings"]["samples"] == 4
    assert found["settings"]["weights"] == {} and found["explained"]["stage2"] > 0
    assert targets.list_not_beaten(found | {"stage2": None}) is None


def test_the_printed_table_has_a_line_for_each_column_with_its_target(
    found: dict[str, Any],
) -> None:
    first, *_, captures, _ = targets.format_table(found).split("\n\n")
    lines = {line.split()[0]: line.split() for line in first.splitlines()}
    assert lines["melanin.r_image"][-2:] == [">=", "0.98"]
    assert lines["diffuse"][4] == "-" and len(lines["diffuse"]) == 6
    assert "coverage.melanin.all" in captures and ">= 0.70" in captures


def test_perfect_predictions_have_no_error(skins: Pictures) -> None:
    scores = Scores()
    scores.add(skins.truth, skins)
    results = scores.compute_results(scores)
    for name in ("diffuse", "specular", "albedo", "reconstruction"):
        assert results[name] == 0
    assert results["melanin"]["rmse"] == results["melanin"]["grid_rmse"] == 0
    assert results["melanin"]["r_pixel"] == pytest.approx(1)
    assert results["melanin"]["r_image"] == pytest.approx(1)
    assert results["mask_iou"] == 1 and results["leak"] is None


def test_melanin_error_that_follows_shading_has_correlation_minus_one(skins: Pictures) -> None:
    shading = torch.rand(len(skins.picture), generator=torch.Generator().manual_seed(0))
    lit = skins._replace(truth=skins.truth._replace(shading=shading))
    scores = Scores()
    scores.add(lit.truth._replace(melanin=lit.truth.melanin - 0.01 * shading), lit)
    assert scores.compute_results(scores)["leak"] == pytest.approx(-1)


def test_running_statistics_agree_with_numpy() -> None:
    x, y = np.random.default_rng(0).normal(0.1, 0.02, (2, 3, 100))
    y = x + 0.5 * y
    moments = RunningStatistics()
    for a, b in zip(x, y, strict=True):
        moments.add(torch.from_numpy(a), torch.from_numpy(b))
    assert moments.r == pytest.approx(np.corrcoef(x.ravel(), y.ravel())[0, 1])
    assert moments.rmse == pytest.approx(np.sqrt(np.mean((x - y) ** 2)))
    assert moments.line == pytest.approx(tuple(np.polyfit(x.ravel(), y.ravel(), 1)))
    assert RunningStatistics().rmse is None and RunningStatistics().r is None


def test_typology_angle_agrees_with_colour_science() -> None:
    linear = np.random.default_rng(0).uniform(0.002, 0.9, (50, 3))
    xyz = colour.RGB_to_XYZ(linear, "sRGB", apply_cctf_decoding=False)
    lightness, _, b = colour.XYZ_to_Lab(xyz, colour.CCS_ILLUMINANTS[
        "CIE 1931 2 Degree Standard Observer"]["D65"]).T  # fmt: skip
    expected = np.rad2deg(np.arctan2(lightness - 50, b))
    assert np.abs(compute_typology_angle(torch.from_numpy(linear)).numpy() - expected).max() < 0.2
    assert [find_group(angle) for angle in (60, 50, 30, 20, 0, -50)] == list(GROUPS)


def test_baselines_order_plain_skins_by_melanin(skins: Pictures) -> None:
    decoder = SkinDecoder()
    lookup, ica = Lookup(decoder), Tsumura(decoder)
    ica.fit(skins)
    by_table, by_directions = lookup(skins), ica(skins)
    assert torch.allclose(by_table.melanin, skins.truth.melanin, atol=2e-3)
    assert torch.allclose(by_table.hemoglobin, skins.truth.hemoglobin, atol=2e-3)
    assert (by_directions.melanin[::16].diff() > 0).all()


def test_the_table_groups_all_tones(skins: Pictures) -> None:
    scores = Scores()
    scores.add(skins.truth._replace(melanin=1.1 * skins.truth.melanin), skins)
    groups = scores.group_by_tone()
    assert sum(one["pictures"] for one in groups.values()) == 6 and len(groups) >= 4
    assert all(one["relative_rmse"] == pytest.approx(0.1, rel=0.2) for one in groups.values())


def test_a_photograph_is_composed_as_the_decoder_does(model: SkinAutoencoder) -> None:
    photograph = astronaut()[:32, :32].copy()
    maps, capture = NetworkReader(model)(photograph)
    reading = model(torch.from_numpy(photograph).movedim(-1, 0)[None] / 255)
    image = compose(maps, capture, model.decoder).image
    assert torch.allclose(image, reading.reconstruction.clamp(0, 1), atol=1e-5)
    assert NetworkReader(model)(astronaut()[:50, :40].copy())[0].offset.shape == (1, 3, 50, 40)


def constant_reader(photograph: np.ndarray) -> tuple[SkinMaps, Any]:
    maps = [torch.full((1, *photograph.shape[:2]), 0.5 + 1e-3)] * 6
    maps[0] = 0.1 * maps[0]
    offset = torch.zeros(1, 3, *photograph.shape[:2])
    return SkinMaps(*maps[:4], offset, maps[5]), SpectralCamera().standard((1,))


def test_a_constant_reading_is_stable(tmp_path: Path) -> None:
    for kind in ("congress", "london"):
        (tmp_path / kind).mkdir()
    Image.fromarray(astronaut()).save(tmp_path / "congress" / "a.jpg")
    found = portraits.measure_portraits(tmp_path, constant_reader, SkinDecoder())
    assert {"reconstruction", "stability", "ita_rank"} <= set(found)
    assert set(found["stability"]) == {
        *("exposure_up", "exposure_down", "cooler", "warmer", "jpeg_40", "half_size", "mirror")
    }
    for change in found["stability"].values():
        assert change == pytest.approx({"melanin": 0, "hemoglobin": 0}, abs=1e-6)
    assert 0 < found["reconstruction"] < 1 and found["ita_rank"] is None


def test_disturbances_change_exposure_size_and_white_point() -> None:
    photograph = np.full((20, 30, 3), 100, np.uint8)
    changed = {name: change(photograph) for name, change in disturbances.DISTURBANCES.items()}
    assert changed["exposure_up"].mean() > 130 and changed["exposure_down"].mean() < 80
    assert changed["half_size"].shape == (10, 15, 3)
    red, _, blue = changed["warmer"][0, 0].astype(int)
    assert red > 100 > blue
    red, _, blue = changed["cooler"][0, 0].astype(int)
    assert red < 100 < blue
    x, y = colour.temperature.CCT_to_xy_CIE_D(7000)
    white = colour.XYZ_to_RGB([x / y, 1, (1 - x - y) / y], "sRGB", apply_cctf_encoding=False)
    x, y = colour.temperature.CCT_to_xy_CIE_D(6500)
    before = colour.XYZ_to_RGB([x / y, 1, (1 - x - y) / y], "sRGB", apply_cctf_encoding=False)
    assert disturbances.compute_gain(7000.0) == pytest.approx(white / before, abs=0.01)


def test_typology_angles_are_relative_to_the_wall() -> None:
    """The colour and exposure of any light are divided out with those of the wall."""
    melanin = torch.logspace(-1.7, -0.6, 6)
    skin = render_under_daylight(melanin, torch.full_like(melanin, 0.04), SkinDecoder()).numpy()
    light = np.random.default_rng(0).uniform(0.5, 1.5, (6, 3))
    light /= np.median(light @ [0.2126, 0.7152, 0.0722])
    blank = np.zeros((1, 1, 3), np.uint8), np.ones((1, 1), bool)
    measured = [
        (
            portraits.Portrait(
                *blank, (rgb * one).astype(np.float32), (0.5 * one).astype(np.float32)
            ),
            m,
        )
        for rgb, one, m in zip(skin, light, melanin.tolist(), strict=True)
    ]
    assert portraits.rank_by_angle(measured) == pytest.approx(-1)
    found = portraits.group_by_tone([(one, [m, 0.04]) for one, m in measured], SkinDecoder())
    assert list(found) == [name for name in GROUPS if name in found] and len(found) > 2
    assert sum(tone["portraits"] for tone in found.values()) == 6
    for tone in found.values():
        assert tone["angle_by_wall"] == pytest.approx(tone["angle_of_skin"], abs=0.01)
