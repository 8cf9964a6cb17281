"""The contact sheet takes people of all tones, once each."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from examples import contact_sheet
from examples.contact_sheet import Person, choose_people, cut_out, measure_tone
from skinnet.images import resize


def test_people_are_spread_over_the_tones() -> None:
    people = [Person(str(tone), np.zeros((2, 2, 3), np.uint8), tone) for tone in (60, 59, 58, 0)]
    assert [person.tone for person in choose_people(people, 2)] == [60, 0]
    assert len(choose_people(people, 9)) == 4


def test_pale_skin_has_the_larger_angle() -> None:
    photo = np.full((20, 40, 3), (230, 195, 175), np.uint8)
    photo[:, 20:] = (80, 52, 40)
    places = np.array([[10, 10], [30, 10]], np.float32)
    assert measure_tone(photo, places[:1], 3.0) > 30 > measure_tone(photo, places[1:], 3.0)


def test_what_is_no_skin_is_green() -> None:
    photo, mask = np.full((2, 2, 3), 200, np.uint8), np.array([[1, 0], [0, 0]], np.float32)
    assert cut_out(photo, mask)[0].tolist() == [[200, 200, 200], list(contact_sheet.BEHIND)]


@pytest.mark.slow
def test_a_page_is_drawn(tmp_path: Path) -> None:
    (tmp_path / "portraits").mkdir()
    Image.fromarray(resize(astronaut(), 300, 300)).save(tmp_path / "portraits" / "a.png")
    words = [str(tmp_path / "portraits"), "-o", str(tmp_path / "sheet.png")]
    assert contact_sheet.main(words) == 0
    with Image.open(tmp_path / "sheet_1.png") as sheet:
        assert sheet.size[0] > 9 * 318


def test_a_folder_without_faces_is_refused(
    tmp_path_factory: pytest.TempPathFactory, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path_factory.mktemp("walls")
    Image.new("RGB", (80, 80), (200, 200, 200)).save(folder / "wall.png")
    assert contact_sheet.main([str(folder), "-o", str(folder / "sheet.png")]) == 2
    assert "no picture with a face" in capsys.readouterr().err
