"""The strip of the README shows each person in a row, beside what is true."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import strip
from examples._portraits import render_portrait

LIGHT, MEDIUM, DARK = strip.SITTERS


def test_people_go_from_pale_to_dark() -> None:
    portraits = [render_portrait(one, 24, None) for one in strip.SITTERS]
    melanin = [one.melanin for one in portraits]
    assert 0.02 < melanin[0] < 0.05 < melanin[1] < 0.15 < melanin[2] < 0.43
    lightness = [one.photo[8:16, 8:16].mean() for one in portraits]
    assert lightness == sorted(lightness, reverse=True)


@pytest.mark.slow
def test_each_person_has_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(strip, "SITTERS", (LIGHT, MEDIUM))
    target = tmp_path / "strip.png"
    assert strip.main(["--size", "160", "-o", str(target)]) == 0
    with Image.open(target) as picture:
        width, height = picture.size
        assert picture.text["skinnet"].startswith("skinnet")  # type: ignore[attr-defined]
    assert width / height > 1.8
    assert np.asarray(Image.open(target)).std() > 20
    assert capsys.readouterr().out.count("true") == 4


def test_a_missing_model_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--ict", str(tmp_path / "absent.npz"), "-o", str(tmp_path / "strip.png")]
    assert strip.main(words) == 2
    assert "absent.npz" in capsys.readouterr().err
