"""Figures of the paper, small, from a few synthetic people."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from small_lightstage import PEOPLE, TEXELS, Studied, run_quickly

from examples import figures, lightstage
from examples._skin_figures import compute_colours, measure_curvature
from skinnet.pipeline import relight


def read(path: Path) -> np.ndarray:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def test_skin_is_curved_in_rgb() -> None:
    line, plane = measure_curvature(compute_colours("paper", 12))
    assert 0.01 < line < 0.1 and plane < 0.01


def test_figures_of_skin_are_drawn(tmp_path: Path) -> None:
    assert figures.main(["2", "3", "-o", str(tmp_path), "--dpi", "30"]) == 0
    spectra, colours = (read(tmp_path / f"figure_{number}.png") for number in (2, 3))
    assert spectra.shape[1] == colours.shape[1] == 315
    assert ((colours[..., 0] > colours[..., 2]) & (colours[..., 2] > 40)).mean() > 0.1


@pytest.mark.slow
def test_figures_of_people_are_drawn(
    studied: Studied, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relight, "TILE_SIZE", 48)
    monkeypatch.setattr(lightstage, "skinnet", run_quickly)
    words = ["6", "7", "8", "-o", str(tmp_path / "figures"), "--lightstage", str(studied.folder)]
    assert figures.main([*words, "--people", PEOPLE, "--texels", TEXELS, "--dpi", "30"]) == 0
    edits, components, measures = (
        read(tmp_path / "figures" / f"figure_{number}.png") for number in (6, 7, 8)
    )
    assert edits.shape[1] == 4 * 318 + 18
    assert components.shape[1] == (5 * 318 + 18) // 2  # three people have two components
    assert measures.std() > 10


def test_other_files_stay(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "figure_2.png").write_bytes(b"mine")
    assert figures.main(["2", "-o", str(tmp_path)]) == 2
    assert "was not written by this example" in capsys.readouterr().err
    assert (tmp_path / "figure_2.png").read_bytes() == b"mine"
