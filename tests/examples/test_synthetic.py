"""The sheet of synthetic pictures, and that of their masks."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import synthetic


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("SIDE", 32), ("ACROSS", 2), ("DOWN", 1)):
        monkeypatch.setattr(synthetic, name, value)


def test_both_sheets_are_written_and_skin_is_green(tmp_path: Path) -> None:
    target = tmp_path / "sheet.png"
    assert synthetic.main(["--geometry", str(tmp_path / "heads"), "-o", str(target)]) == 0
    sheet, mask = (
        np.asarray(Image.open(one), float) for one in (target, tmp_path / "sheet_mask.png")
    )
    assert sheet.shape == mask.shape == (32, 64, 3)
    tint = mask[..., 1] - mask[..., [0, 2]].max(-1)
    assert (tint > tint.max() / 2).mean() > 0.02


def test_another_picture_is_not_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "sheet_mask.png").write_bytes(b"mine")
    assert synthetic.main(["-o", str(tmp_path / "sheet.png")]) == 2
    assert "sheet_mask.png is there already" in capsys.readouterr().err
    assert (tmp_path / "sheet_mask.png").read_bytes() == b"mine"
