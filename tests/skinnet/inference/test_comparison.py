"""Two photographs of a face are compared: light is told from skin, and local changes are seen."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage
from skimage.transform import resize

from skinnet import Decomposer
from skinnet.cli import main
from skinnet.errors import InputError, NoFaceError
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference import Capture, Comparison, compare_photographs
from skinnet.inference._comparison.changes import Change, PigmentChanges
from skinnet.inference.comparison import _refuse_other_person

WARM = np.array([1.15, 1.0, 0.8], np.float32)


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


def relight(photo: np.ndarray, gains: np.ndarray = 0.8 * WARM) -> np.ndarray:
    """The same photograph in another light."""
    return to_uint8(linear_to_srgb(np.clip(srgb_to_linear(photo) * gains, 0, 1)))


@pytest.fixture(scope="module")
def flushed_cheek(astronaut: np.ndarray, decomposer: Decomposer) -> np.ndarray:
    """A photograph with more blood in the left cheek, in another light."""
    cheek = decomposer(astronaut, detail=False).region_mask("left_cheek")
    soft = ndimage.gaussian_filter(cheek.astype(float), 3)[..., None]
    flushed = decomposer.edit(astronaut, hemoglobin=4.0)
    return relight(np.rint(soft * flushed + (1 - soft) * astronaut).astype(np.uint8))


@pytest.fixture(scope="module")
def flush(astronaut: np.ndarray, flushed_cheek: np.ndarray, decomposer: Decomposer) -> Comparison:
    return compare_photographs(astronaut, flushed_cheek, decomposer=decomposer)


def test_another_light_is_no_change(astronaut: np.ndarray, decomposer: Decomposer) -> None:
    found = compare_photographs(astronaut, relight(astronaut), decomposer=decomposer)
    np.testing.assert_allclose(found.light, np.log(WARM[::2]), atol=0.03)
    assert found.face.unchanged and found.other_cells > 50
    assert abs(found.face.melanin.log) < 0.05 and abs(found.face.hemoglobin.log) < 0.1
    assert np.nanmax(np.abs(found.melanin)) < 0.15


def test_a_face_elsewhere_in_the_picture_is_unchanged(
    astronaut: np.ndarray, decomposer: Decomposer
) -> None:
    moved = resize(np.roll(astronaut, (18, -25), (0, 1)), (640, 640)) * 255
    found = compare_photographs(astronaut, np.rint(moved).astype(np.uint8), decomposer=decomposer)
    assert found.face.unchanged and abs(found.face.melanin.log) < 0.1
    skin = np.isfinite(found.melanin)
    assert np.abs(found.before[skin].astype(int) - found.after[skin]).mean() < 6


def test_a_flushed_cheek_is_seen_in_another_light(flush: Comparison) -> None:
    cheek, other = flush.regions["left_cheek"], flush.regions["right_cheek"]
    assert cheek is not None and other is not None
    local = cheek.against_rest
    assert local.hemoglobin.interval[0] > 0 and local.melanin.unchanged
    assert local.hemoglobin.sd < 0.8 * cheek.total.hemoglobin.sd
    assert other.against_rest.hemoglobin.log < 0.5 * local.hemoglobin.log
    right, left = np.array_split(flush.hemoglobin, 2, axis=1)
    assert np.nanmax(left) > 3 * max(np.nanmax(right), 0.05)


def test_more_melanin_is_melanin(astronaut: np.ndarray, decomposer: Decomposer) -> None:
    tanned = relight(decomposer.edit(astronaut, melanin=1.8))
    face = compare_photographs(astronaut, tanned, decomposer=decomposer).face
    assert face.melanin.log > 0.2 and abs(face.hemoglobin.log) < face.melanin.log


def test_what_is_known_of_the_captures_makes_it_no_less_sure(
    astronaut: np.ndarray, decomposer: Decomposer, flush: Comparison, flushed_cheek: np.ndarray
) -> None:
    white = Capture(light={"D": 1.0}, temperature=5500.0, white_balance=(0.0, 0.0))
    warm = white._replace(white_balance=tuple(np.log(WARM[::2]).tolist()))
    known = compare_photographs(
        astronaut, flushed_cheek, decomposer=decomposer, before_capture=white, after_capture=warm
    )
    assert known.face.melanin.sd < flush.face.melanin.sd


def test_the_summary_is_json_and_the_picture_has_four_tiles(flush: Comparison) -> None:
    summary = json.loads(json.dumps(flush.summary(), allow_nan=False))
    assert set(summary["face"]["melanin"]) >= {"log", "interval", "percent", "unchanged"}
    assert set(summary["regions"]["nose"]["against_rest"]) == set(summary["face"])
    picture = flush.draw()
    assert picture.shape[1] == 4 * 318 + 18 and "hemoglobin" in repr(flush)


def test_a_photograph_without_a_face_is_named(
    astronaut: np.ndarray, decomposer: Decomposer
) -> None:
    wall = np.full((90, 120, 3), (220, 180, 160), np.uint8)
    with pytest.raises(NoFaceError, match=r"No face was found in late\.jpg; a comparison"):
        compare_photographs(
            astronaut,
            wall,
            decomposer=decomposer,
            names=("early.jpg", "late.jpg"),
        )


def test_plainly_different_people_are_refused() -> None:
    small = Change(0.1, 0.2)
    _refuse_other_person(PigmentChanges(Change(1.2, 0.2), small, False), ("a", "b"))
    with pytest.raises(InputError, match="b and a plainly show different people"):
        _refuse_other_person(PigmentChanges(Change(1.8, 0.2), small, False), ("a", "b"))
    with pytest.raises(InputError, match="a and b plainly show different people"):
        _refuse_other_person(PigmentChanges(Change(-1.8, 0.2), small, False), ("a", "b"))


def test_the_command_writes_a_picture_and_a_summary(
    astronaut: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after = tmp_path / "before.png", tmp_path / "after.png"
    Image.fromarray(astronaut).save(before)
    Image.fromarray(relight(astronaut)).save(after)
    for options in ([], ["--light", "D65"]):  # its own results are replaced
        assert main(["compare", str(before), str(after), "--json", *options]) == 0
        summary = json.loads(capsys.readouterr().out)
        assert summary["face"]["unchanged"]
    folder = tmp_path / "skinmaps"
    names = ["before_after_comparison.json", "before_after_comparison.png"]
    assert sorted(path.name for path in folder.iterdir()) == names
    # A result is no photograph.
    assert main(["compare", str(folder / names[1]), str(after)]) == 2
    # What another photograph of the same name has left is not replaced.
    Image.fromarray(astronaut).save(after)
    assert main(["compare", str(before), str(after)]) == 0
    assert (folder / "before_after_comparison-2.json").is_file()
    assert "(unchanged); 2 files" in capsys.readouterr().out


def test_an_edit_of_the_other_photograph_is_said_to_be_one(
    astronaut: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, after = tmp_path / "a.png", tmp_path / "a_edited.png"
    Image.fromarray(astronaut).save(before)
    assert main(["edit", str(before), "--melanin", "1.5"]) == 0
    for names in ((before, after), (after, before)):
        assert main(["compare", *map(str, names)]) == 0
        assert f"{after} is an edit of {before} by skinnet." in capsys.readouterr().err
    Image.fromarray(astronaut[:, 1:]).save(before)
    assert main(["compare", str(before), str(after)]) == 0
    assert "is an edit of" not in capsys.readouterr().err


def test_the_command_reports_bad_input_and_writes_nothing(
    astronaut: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before, wall = tmp_path / "before.png", tmp_path / "wall.png"
    Image.fromarray(astronaut).save(before)
    Image.new("RGB", (120, 90), (220, 180, 160)).save(wall)
    assert main(["compare", str(before), str(wall)]) == 2
    assert "wall.png" in capsys.readouterr().err
    assert main(["compare", "-", "-"]) == 2
    assert main(["compare", str(before), str(before), "--white", "3,4"]) == 2
    assert "one picture" in capsys.readouterr().err
    assert main(["compare", str(before), str(tmp_path / "absent.png")]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["before.png", "wall.png"]
