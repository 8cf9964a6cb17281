"""The row of tiles of the astronaut."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import astronaut


def test_the_row_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "astronaut.png"
    assert astronaut.main(["-o", str(target)]) == 0
    row = np.asarray(Image.open(target))
    assert row.shape[1] == 6 * 318 + 18
    assert "melanin" in capsys.readouterr().out


def test_another_picture_is_not_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.png").write_bytes(b"mine")
    assert astronaut.main(["-o", str(tmp_path / "mine.png")]) == 2
    assert "mine.png is there already" in capsys.readouterr().err
