"""The fit of the shipped model: the same for a seed, near its truth, and refused in a sentence."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance import DynamicModel
from train.dynamic import __main__ as command
from train.dynamic.charted_faces import ChartedFaces
from train.dynamic.state_patterns import PATTERNS, PLACES, STATES, draw_pattern


@pytest.fixture(scope="module")
def faces() -> ChartedFaces:
    """Three faces of noise on the shipped chart."""
    rng, size = np.random.default_rng(0), 96
    maps = 0.05 * np.exp(0.15 * rng.standard_normal((3, size, size)))
    maps[:, :8] = np.nan
    angles = np.full((size, size, 2), np.nan)
    return ChartedFaces(DynamicModel.load().landmarks.astype(float), maps, angles)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, faces: ChartedFaces) -> None:
    monkeypatch.setattr(command, "chart_faces", lambda *_: faces)
    few = {name: PATTERNS[name] for name in ("flush", "pallor")}
    monkeypatch.setattr(command, "PATTERNS", few)


@pytest.mark.usefixtures("quick")
def test_a_seed_gives_the_same_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [tmp_path / "a.npz", tmp_path / "b.npz"]
    for path in paths:
        assert command.main(["-o", str(path), "--frames", "60"]) == 0
    assert '"field_r": 0.9' in capsys.readouterr().out
    with np.load(paths[0]) as one, np.load(paths[1]) as other:
        assert all(np.array_equal(one[name], other[name]) for name in one)
    model = DynamicModel.load(paths[0])
    assert model.names == ("flush", "pallor") and {*model.states} == {"flush", "pallor"}
    assert model.seconds.tolist() == [8.0, 4.0]
    flush, pallor = model.mean[:, 20:36, 12:36]
    assert flush.min() > 0 > pallor.max()


@pytest.mark.usefixtures("quick")
def test_bad_output_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(["-o", str(tmp_path / "a.json"), "--frames", "60"]) == 2
    assert "does not end in .npz" in capsys.readouterr().err


def test_states_are_made_of_coefficients_with_a_source() -> None:
    for name, pattern in PATTERNS.items():
        assert {*pattern.places} <= {*PLACES} and len(pattern.source) > 30, name
    assert {"flush", "pallor", "exertion", "smile", "frown"} <= {*STATES}


def test_patterns_are_symmetric_and_strongest_where_they_say() -> None:
    landmarks = DynamicModel.load().landmarks.astype(float)
    mean, spread = draw_pattern(PATTERNS["flush"], landmarks, 96)
    assert np.abs(mean - mean[:, ::-1]).max() < 0.1
    row, column = (landmarks[50, ::-1] * 96).astype(int)
    assert mean[row, column] > 0.95 * mean.max() and spread.max() == pytest.approx(0.2)
