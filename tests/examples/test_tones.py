"""The sheet of edited tones shows skin."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.edits import make_colour
from examples import tones


def test_skins_go_from_pale_to_dark() -> None:
    melanin = [skin[0] for skin in tones.choose_skins(make_colour("measured"))]
    assert melanin == sorted(melanin)
    assert 0.03 < melanin[0] < 0.07 and 0.2 < melanin[-1] < 0.43


def test_no_edited_face_is_blue() -> None:
    edits = [("melanin", 1.0), ("melanin", 0.5), ("blood", 0.25)]
    sheet = tones.draw_sheet(64, 48, edits).astype(int)
    spread = sheet.max(-1) - sheet.min(-1)
    coloured = sheet[spread > 12]
    assert len(coloured) > 0.1 * spread.size
    assert np.mean(coloured[:, 2] > coloured[:, 0]) < 0.001


def test_the_sheet_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tones, "draw_sheet", lambda texels, size: np.zeros((texels, size, 3), "u1"))
    tones.main(["-o", str(tmp_path / "new" / "tones.png"), "--texels", "8", "--size", "16"])
    assert (tmp_path / "new" / "tones.png").is_file()
