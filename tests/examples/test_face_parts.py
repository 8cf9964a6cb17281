"""The sheet of the parts of faces."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from examples import face_parts
from skinnet.images import resize
from skinnet.images.faces._face_regions import REGION_NAMES


def test_names_have_tints_of_their_own() -> None:
    assert tuple(face_parts.TINTS) == REGION_NAMES
    assert len(set(face_parts.TINTS.values())) == len(REGION_NAMES)


def test_each_photograph_has_a_row(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    photo, output = tmp_path / "a.png", tmp_path / "sheet.png"
    Image.fromarray(resize(astronaut(), 300, 300)[:, :250]).save(photo)
    assert face_parts.main([str(photo), str(photo), "-o", str(output)]) == 0
    sheet = np.array(Image.open(output)).astype(int)
    assert sheet.shape == (2 * face_parts.SIDE, 2 * face_parts.SIDE, 3)
    plain, tinted = np.split(sheet, 2, axis=1)
    assert 0.03 < (plain != tinted).any(-1).mean() < 0.3
    assert face_parts.main([str(photo), "-o", str(photo)]) == 2
    assert "was not written by this example" in capsys.readouterr().err
