"""Faces whose expression and blood change, drawn and animated."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from examples import dynamic
from examples._living_face import LivingFace
from skinnet.appearance import DynamicModel


@pytest.fixture(scope="module")
def face() -> LivingFace:
    return LivingFace(dynamic.SITTERS[0], 128, None, DynamicModel.load())


def test_blood_and_expression_change_the_picture(face: LivingFace) -> None:
    rest, flushed, pale = (
        face.render({}, blood).astype(float) for blood in ({}, {"flush": 1.0}, {"pallor": 1.0})
    )
    cheek = tuple((face._rest.landmarks[50, ::-1] / 2).astype(int))
    redness = [each[cheek][0] / each[cheek][1] for each in (pale, rest, flushed)]
    assert redness == sorted(redness)
    assert np.array_equal(rest[:8], flushed[:8])
    smiling = face.render({"smile": 1.0}, {}).astype(float)
    changed = np.abs(smiling - rest).max(-1) > 20
    assert 0.002 < changed.mean() < 0.2


def test_the_figure_has_a_row_for_each_person(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(dynamic, "SITTERS", dynamic.SITTERS[:1])
    columns = {name: dynamic.COLUMNS[name] for name in ("at rest", "flush 0.7")}
    monkeypatch.setattr(dynamic, "COLUMNS", columns)
    target = tmp_path / "dynamic.png"
    assert dynamic.main(["--size", "128", "-o", str(target)]) == 0
    with Image.open(target) as picture:
        assert picture.width > 1.5 * picture.height
    assert "written" in capsys.readouterr().out


def test_an_animation_plays_the_blood_of_a_track(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, face: LivingFace
) -> None:
    monkeypatch.setattr(dynamic, "LivingFace", lambda *_: face)
    names = ("forehead", "left_cheek", "right_cheek", "nose", "lips", "chin")
    head = ",".join(["time", *(f"{name}_log_ratio" for name in names)])
    table = tmp_path / "a_track.csv"
    table.write_text(f"{head}\n0,0,0,0,0,0,0\n1,.4,.9,.9,.5,.2,.3\n")
    folder = tmp_path / "frames"
    assert dynamic.main(["--animation", str(folder), "--track", str(table)]) == 0
    frames = [np.asarray(Image.open(one), float) for one in sorted(folder.iterdir())]
    assert len(frames) == 2
    cheek = tuple((face._rest.landmarks[50, ::-1] / 2).astype(int))
    assert frames[1][cheek][1] < frames[0][cheek][1] - 3
    assert dynamic.main(["--animation", str(folder), "--track", str(table)]) == 2


def test_a_photograph_takes_the_blood(tmp_path: Path) -> None:
    photo = tmp_path / "a.png"
    Image.fromarray(astronaut()[:256, 90:346]).save(photo)
    draw = dynamic.draw_photo(photo)
    rest, flushed = draw(0.0, {"flush": 0.0}), draw(1.0, {"flush": 1.0})
    assert np.array_equal(rest, astronaut()[:256, 90:346])
    assert (flushed != rest).any()


def test_names_that_cannot_be_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert dynamic.main(["--animation", str(tmp_path / "a.gif")]) == 2
    assert "ends in neither .mp4" in capsys.readouterr().err
    assert dynamic.main(["--size", "8"]) == 2
