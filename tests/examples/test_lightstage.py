"""A few synthetic people through the whole pipeline, small."""

from pathlib import Path

import pytest
from pipeline_scans import FAST

from examples import lightstage
from skinnet.cli import main as skinnet
from skinnet.pipeline import relight

QUICK = {"maps": FAST, "build-model": ("--appearance.samples=3",)}


@pytest.mark.slow
def test_people_become_models(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(relight, "TILE_SIZE", 48)
    monkeypatch.setattr(lightstage, "skinnet", lambda words: skinnet([*words, *QUICK[words[0]]]))
    assert lightstage.main(["-o", str(tmp_path), "--people", "3", "--texels", "32"]) == 0
    for folder in ("model", "model_effect"):
        assert (tmp_path / folder / "hybrid.npz").is_file()
    printed = capsys.readouterr().out
    assert "transform: relative error" in printed and "f_blood: median of each person" in printed
