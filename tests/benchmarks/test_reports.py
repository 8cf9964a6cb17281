"""The benchmarks' figures: those that are accuracies reach their targets; no time is asserted."""

import json
import sys

import pytest
import torch

from benchmarks import appearance, calibration, decoder, lookup, report
from benchmarks.biofacenet import BioFaceNetShape
from benchmarks.recovered_spectra import load_d65_matrix
from skinnet.physics import PRESETS, SkinReflectance

pytestmark = pytest.mark.slow


@pytest.mark.skipif(sys.platform != "linux", reason="Resident peaks are read from /proc.")
def test_decoder_reports_its_figures() -> None:
    found = decoder.measure(images=2, size=64, rounds=1)
    ways = {"fast", "bands", "grid", "grid_matmul"}
    figures = {f"speedup_vs_{way}" for way in ways - {"fast"}} | {"memory_ratio"}
    figures |= {"max_error", "gradient_error", "gradient_error_by_preset"}
    assert set(found) == figures | {"seconds", "memory_mb"}
    by_preset = found["gradient_error_by_preset"]
    assert set(by_preset) == set(PRESETS) - {"printed"}
    assert found["gradient_error"] == max(by_preset.values())
    assert set(found["seconds"]) == ways and set(found["memory_mb"]) == {"fast", "bands"}
    assert found["max_error"] <= 5e-4 and found["gradient_error"] <= 0.01


@pytest.mark.parametrize("at_once", [True, False])
def test_the_spectral_grid_agrees_with_the_decoder(at_once: bool) -> None:
    bands = decoder.SkinDecoder(fast=False)
    scene = decoder.sample_scene(2, 32)
    expected = decoder.decode(bands, *scene)
    assert torch.allclose(decoder.SpectralGrid(bands, at_once)(*scene), expected, atol=1e-3)


def test_report_is_a_table_or_one_object(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    results: report.Results = {"a": {"median": 0.25, "n": 3}, "b": 1e-4}
    monkeypatch.setattr(sys, "argv", ["benchmark", "--json"])
    report.main(lambda: results, "")
    assert json.loads(capsys.readouterr().out) == results
    monkeypatch.setattr(sys, "argv", ["benchmark"])
    report.main(lambda: results, "")
    assert capsys.readouterr().out.split() == ["a.median", "0.25", "a.n", "3", "b", "0.0001"]


def test_the_rival_network_has_four_maps_and_its_globals() -> None:
    *maps, scene = BioFaceNetShape().eval()(torch.rand(1, 3, 32, 48))
    assert [tuple(value.shape) for value in maps] == [(1, 1, 32, 48)] * 4
    assert scene.shape == (1, 15)


@pytest.mark.skipif(sys.platform != "linux", reason="Resident peaks are read from /proc.")
def test_appearance_reports_its_figures() -> None:
    found = appearance.measure_costs(count=4, size=24, many=6, small=16)
    assert set(found) == {"pca_s", "fit_peak_gb", "peak_gb", "write_s", "seconds", "many"}
    steps = {"hybrid", "linear", "measure_hybrid", "measure_linear"}
    assert set(found["seconds"]) == steps
    assert found["many"]["people"] == 6 and set(found["many"]["seconds"]) == {"hybrid", "linear"}
    assert 0 < found["fit_peak_gb"] <= found["peak_gb"] < 4


def test_lookup_reports_its_figures() -> None:
    found = lookup.measure(size=96, nodes=96, rounds=1)
    pair = {"speedup_vs_kdtree", "speedup_with_building", "same_as_brute_force"}
    pair |= {f"{name}seconds" for name in ("query_", "build_", "kdtree_", "kdtree_build_")}
    own = {"seconds", "refined_seconds", "table_seconds", "on_manifold", "skin", "posterior"}
    own |= {f"round_trip_{name}" for name in ("median", "p99", "max")}
    assert set(found) == pair | own and set(found["skin"]) == pair
    assert found["same_as_brute_force"] and found["skin"]["same_as_brute_force"]
    assert found["round_trip_median"] <= 1e-4 and found["round_trip_p99"] <= 1e-3
    posterior = found["posterior"]
    assert set(posterior) == {"mel_error_p99", "blood_error_p99"} | {
        f"{name}seconds" for name in ("", "table_")
    } | {"seconds_with_table"}
    assert posterior["mel_error_p99"] < 0.05 and posterior["blood_error_p99"] < 0.05


def test_the_map_of_the_lookup_has_no_equal_texels() -> None:
    skin, matrix = (
        lookup.SkinLookup(SkinReflectance(dtype=torch.float64)),
        load_d65_matrix(),
    )
    for rgb in lookup.render_face(skin, matrix, 128):
        assert rgb.dtype == torch.float32 and rgb.shape == (128, 128, 3)
        assert len(rgb.reshape(-1, 3).unique(dim=0)) == 128**2


def test_calibration_reports_its_figures() -> None:
    found = calibration.measure(("all",), (0.005,), seeds=1, crowds=1, count=1000)
    columns = {"trials", "error", "worst_error", "uncertainty", "covered", "refused", "seconds"}
    assert set(found["all_0.5%"]) == set(found["people"]) == columns
    assert found["trials"] == 3 and found["all_0.5%"]["error"] < 0.1
    assert found["example_error"] == found["people"]["error"] and found["lines"] > 50
    assert "| people |" in calibration.layout(found)
