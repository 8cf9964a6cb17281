"""People in two photographs each, as training data."""

import csv
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from skimage.data import astronaut

from skinnet.errors import InputError
from train.pair_split import choose_kept
from train.pairs import PeopleStream, PortraitPairs
from train.people import REGIONS, crop_person, measure_colour, read_couples
from train.synthetic.faces import SyntheticFaces

PEOPLE = ("Ada", "Bo", "Cy")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three people, whose second photographs are darker and bluer."""
    made = tmp_path_factory.mktemp("pairs")
    photo = astronaut()[:300, 60:390]
    with (made / "index.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("person", "first", "second"))
        for number, person in enumerate(PEOPLE):
            names = f"{person}_1.png", f"{person}_2.png"
            Image.fromarray(photo[:, number:]).save(made / names[0])
            darker = (photo * [0.6, 0.65, 0.75]).astype(np.uint8)
            Image.fromarray(darker[:, : 320 - number]).save(made / names[1])
            rows.writerow((person, *names))
    return made


def test_a_person_has_regions_and_a_colour(folder: Path) -> None:
    first, second = (crop_person(folder / f"Ada_{one}.png", 96) for one in (1, 2))
    assert first is not None and second is not None
    assert first.photograph.shape == (96, 96, 3)
    shares = [(first.regions == 1 + number).mean() for number in range(len(REGIONS))]
    assert min(shares) > 0.003 and max(shares) < 0.06
    rows = [np.nonzero(first.regions == 1 + number)[0].mean() for number in (0, 3, 4)]
    assert rows == sorted(rows)  # forehead, nose, chin
    red, blue, level = (second.colour - first.colour).tolist()
    assert red < -0.1 and blue > 0.2 and level < -0.7


def test_the_colour_is_that_of_the_median() -> None:
    skin = np.array([[200, 120, 100], [188, 125, 99], [150, 130, 90]], np.uint8)
    linear = ((np.array([188, 125, 99]) / 255 + 0.055) / 1.055) ** 2.4
    expected = np.log([linear[0] / linear[1], linear[2] / linear[1]])
    np.testing.assert_allclose(measure_colour(skin)[:2], expected, rtol=1e-4)


def test_people_without_two_usable_photographs_are_left_out(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    Image.new("RGB", (80, 80)).save(tmp_path / "Bo_2.png")
    assert set(read_couples(tmp_path, 32)) == {"Ada", "Cy"}
    assert f"{tmp_path}: 1 people left out" in capsys.readouterr().err
    for person in ("Ada", "Cy"):
        Image.new("RGB", (80, 80)).save(tmp_path / f"{person}_2.png")
    with pytest.raises(InputError, match="shows no person in two usable photographs"):
        read_couples(tmp_path, 32)


@pytest.mark.parametrize(
    ("content", "message"),
    [(None, "cannot be read"), ("a,b\n1,2\n", "lacks rows or one of its columns"), ("", "lacks")],
)
def test_a_folder_without_an_index_is_refused(
    tmp_path: Path, content: str | None, message: str
) -> None:
    if content is not None:
        (tmp_path / "index.csv").write_text(content)
    with pytest.raises(InputError, match=message) as caught:
        read_couples(tmp_path, 32)
    assert "person, first and second" in str(caught.value)


def make_data(folder: Path, kept: int = 1) -> PortraitPairs:
    data = PortraitPairs(str(folder), 32, 2, kept, synthetic=SyntheticFaces(size=32))
    return data


def test_those_who_are_kept_are_never_trained_on(folder: Path) -> None:
    data = make_data(folder)
    data.read()
    (kept,) = choose_kept(PEOPLE, 1)
    alone = read_couples(folder, 32)[kept]
    assert len(data.couples["train"]) == 2
    assert np.array_equal(data.couples["val"][0][0].photograph, alone[0].photograph)
    with pytest.raises(InputError, match="shows 3 people and 3 are kept"):
        make_data(folder, 3).read()


def test_each_part_needs_somebody(folder: Path, tmp_path: Path) -> None:
    for file in folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (kept,) = choose_kept(PEOPLE, 1)
    Image.new("RGB", (80, 80)).save(tmp_path / f"{kept}_2.png")
    with pytest.raises(InputError, match="that are kept for testing"):
        make_data(tmp_path).read()


def test_sizes_must_agree(folder: Path) -> None:
    data = PortraitPairs(str(folder), 64, synthetic=SyntheticFaces(size=32))
    with pytest.raises(InputError, match=r"give --data\.init_args\.size"):
        data.setup("fit")


def test_the_stream_is_the_same_for_the_same_seed_and_mirrors_all_layers(folder: Path) -> None:
    couples = list(read_couples(folder, 32).values())
    stream, again = PeopleStream(couples, 3), PeopleStream(couples, 3)
    for index in (0, 4, 5):
        for one, other in zip(stream[index], again[index], strict=True):
            assert torch.equal(one.photograph, other.photograph)
            assert torch.equal(one.change.gain, other.change.gain)
    originals = [each for couple in couples for each in couple]
    mirrored = 0
    for index in range(12):
        for shot in stream[index]:
            flipped = [torch.from_numpy(one.photograph).flip(1) for one in originals]
            found = [n for n, one in enumerate(flipped) if torch.equal(one, shot.photograph)]
            mirrored += bool(found)
            regions = [torch.from_numpy(originals[n].regions).flip(1) for n in found]
            assert not found or any(torch.equal(shot.regions, one) for one in regions)
    assert 4 < mirrored < 20
