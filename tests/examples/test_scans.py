"""The real scans, small, where their data are; and their commands where they are not."""

from pathlib import Path

import numpy as np
import pytest
from pipeline_scans import FAST, write_scan

from examples import scans
from skinnet.cli import main as skinnet
from skinnet.pipeline import relight

ROOT = Path(__file__).parents[2]
QUICK = {"maps": (*FAST, "--warp.size=48"), "edit-maps": ("--relight.size=64",)}


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relight, "TILE_SIZE", 48)


def run_quickly(words: list[str]) -> int:
    return skinnet([*words, *QUICK[words[0]]])


def run_procedurally(words: list[str]) -> int:
    """Run a command without ICT-FaceKit; the procedural model fits the scans of these tests."""
    if "--shape" in words:
        place = words.index("--shape")
        words = [*words[:place], *words[place + 2 :]]
    if "--colour.white" in words:  # The texture of these scans is white-balanced.
        place = words.index("--colour.white")
        words = [*words[:place], *words[place + 2 :]]
    return run_quickly(words)


def check_results(folder: Path) -> None:
    for name in ("head", "james"):
        with np.load(folder / f"{name}_maps.npz") as maps:
            assert maps["mask"].any()
        assert (folder / f"{name}_edited_panel.png").is_file()


@pytest.mark.slow
def test_both_scans_are_edited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = tmp_path / "data"
    for number, place in enumerate(("lps/head.obj", "james/james.obj"), 1):
        (data / "scans" / place).parent.mkdir(parents=True)
        write_scan(data / "scans" / place, number)
    monkeypatch.setattr(scans, "skinnet", run_procedurally)
    assert scans.main([str(data), "-o", str(tmp_path / "results")]) == 0
    check_results(tmp_path / "results")


@pytest.mark.slow
def test_the_real_scans_are_edited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = ROOT.parent / "shared" / "data"
    if not (data / "scans").is_dir():
        pytest.skip(f"{data / 'scans'} is not there")
    monkeypatch.setattr(scans, "skinnet", run_quickly)
    assert scans.main([str(data), "-o", str(tmp_path)]) == 0
    check_results(tmp_path)
