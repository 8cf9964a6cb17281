"""The edited albedos: four pictures, and what they show."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import albedo


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(albedo, "TONES", {"medium": 24, "dark": 7})
    edits = {"freckles": ["--brush", "freckles:size=0.05"], "tan": ["--preset", "tan"]}
    monkeypatch.setattr(albedo, "PICTURES", {"presets": edits})
    monkeypatch.setattr(albedo, "CLOSE", edits)


def test_pictures_show_an_albedo_and_its_edits_of_each_tone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert albedo.main(["-o", str(tmp_path), "--texels", "64"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        "albedo_presets.png",
        "albedo_closeup.png",
    }
    with Image.open(tmp_path / "albedo_presets.png") as picture:
        sheet = np.asarray(picture, float)
    cells = sheet[:, : sheet.shape[1] // 3 * 3].reshape(len(sheet), 3, -1)
    plain, freckled, tanned = cells.mean((0, 2))
    assert tanned < freckled < plain
    assert capsys.readouterr().out.count("written:") == 2


def test_other_pictures_are_not_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "albedo_closeup.png").write_bytes(b"mine")
    assert albedo.main(["-o", str(tmp_path)]) == 2
    assert "albedo_closeup.png is there already" in capsys.readouterr().err
    assert albedo.main(["-o", str(tmp_path / "new"), "--texels", "3"]) == 2
    assert "texels is a number from 64" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["albedo_closeup.png"]
