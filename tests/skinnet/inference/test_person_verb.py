"""`skinnet person`: bad files are named and the rest goes on; both files are written or none."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from flat_decomposer import SKIN, WALL, names, run, save
from PIL import Image

from skinnet.cli import main
from skinnet.images._mark import read_mark

Run = Callable[..., tuple[int, str, str]]
REDDER, DARK = (214, 140, 120), (60, 40, 30)
"""Colours of the same skin under other light (melanin .214), and of another skin (melanin .060)."""

__all__ = ["run"]


@pytest.fixture
def shots(tmp_path: Path) -> list[Path]:
    return [
        save(tmp_path / f"{name}.png", colour)
        for name, colour in zip("ab", (SKIN, REDDER), strict=True)
    ]


def load(path: Path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def test_shots_are_fused_into_a_panel_and_a_summary(run: Run, shots: list[Path]) -> None:
    code, out, err = run("person", *shots)
    folder = shots[0].parent / "skinmaps"
    assert code == 0 and names(folder) == ["a_person.json", "a_person.png"]
    melanin, hemoglobin = (
        f"{name} {100 * one['mean']:.2g} % (90 %: {100 * low:.2g} to {100 * high:.2g} %)"
        for name, one in load(folder / "a_person.json")["pigments"].items()
        for low, high in [one["interval"]]
    )
    assert out.startswith(f"2 shots of 2 sessions: {melanin}, {hemoglobin} on skin; 2 files")
    assert "2 photographs, 2 faces read, 0 not read, " in err
    summary = load(folder / "a_person.json")
    assert [shot["file"] for shot in summary["shots"]] == [str(each) for each in shots]
    assert [shot["input"]["path"] for shot in summary["shots"]] == ["../a.png", "../b.png"]
    melanin = summary["pigments"]["melanin"]
    assert melanin["mean"] == pytest.approx(np.sqrt(0.2 * 0.214), rel=1e-4)
    assert melanin["sd"] / melanin["mean"] == pytest.approx(0.1 * np.sqrt(0.5 + 0.45 / 2), rel=1e-4)
    with Image.open(folder / "a_person.png") as panel:
        assert panel.width == 1290


def test_json_alone_goes_to_standard_output(run: Run, shots: list[Path], tmp_path: Path) -> None:
    code, out, _ = run("person", tmp_path, "--json", "-o", tmp_path / "out")
    (line,) = out.splitlines()
    assert code == 0 and json.loads(line) == load(tmp_path / "out" / "a_person.json")


def test_bad_files_are_named_and_the_rest_goes_on(
    run: Run, shots: list[Path], tmp_path: Path
) -> None:
    (tmp_path / "bad.jpg").write_bytes(b"")
    save(tmp_path / "wall.png", WALL)
    code, out, err = run("person", *shots, tmp_path / "bad.jpg", tmp_path / "wall.png", "no.jpg")
    assert code == 2 and out.startswith("2 shots of 2 sessions")
    assert "bad.jpg is empty" in err and "No face was found in" in err
    assert "There is no file no.jpg" in err
    assert "2 photographs, 2 faces read, 3 not read (2 could not be read, 1 without a face)" in err


def test_a_left_out_shot_is_named_with_exit_code_2(
    run: Run, shots: list[Path], tmp_path: Path
) -> None:
    other = save(tmp_path / "other.png", DARK)
    code, out, err = run("person", other, *shots)
    assert code == 2 and out.startswith("2 shots of")
    assert f"{other} was left out: its melanin, 0.06, is plainly not the 0.21" in err
    summary = load(tmp_path / "skinmaps" / "other_person.json")
    assert [shot["session"] for shot in summary["shots"]] == [None, 1, 2]


def test_two_people_are_refused_and_nothing_is_written(
    run: Run, shots: list[Path], tmp_path: Path
) -> None:
    code, out, err = run("person", shots[0], save(tmp_path / "other.png", DARK))
    assert code == 2 and out == ""
    assert "The shots are plainly not of one skin: melanin is 0.06 in" in err
    assert names(tmp_path) == ["a.png", "b.png", "other.png"]


def test_one_shot_is_refused(run: Run, shots: list[Path], tmp_path: Path) -> None:
    again = tmp_path / "copy.png"
    again.write_bytes(shots[0].read_bytes())
    code, out, err = run("person", shots[0], again)
    assert code == 2 and out == ""
    assert f"{again} has the same content as {shots[0]}; it counts once." in err
    assert "from two shots or more; got 1 with skin. skinnet predict" in err


def test_a_group_cannot_be_one_person(run: Run, shots: list[Path]) -> None:
    for faces in ("all", "2"):
        code, _, err = run("person", *shots, "--faces", faces)
        assert code == 2
        assert f"person reads the largest face of each photograph; got --faces {faces}." in err
    assert run("person", *shots, "--faces", "1")[0] == 0
    assert "faces is all, largest, or how many" in run("person", *shots, "--faces", "0")[2]


def test_the_same_shots_replace_their_results_and_others_do_not(
    run: Run, shots: list[Path], tmp_path: Path
) -> None:
    folder = tmp_path / "skinmaps"
    for each in (shots, shots):
        assert run("person", *each)[0] == 0
    assert names(folder) == ["a_person.json", "a_person.png"]
    third = save(tmp_path / "c.png", (208, 140, 125))
    assert run("person", *shots, third)[0] == 0
    assert "a_person-2.json" in names(folder)
    (folder / "b_person.png").write_text("mine")
    assert run("person", *reversed(shots))[0] == 0
    assert (folder / "b_person.png").read_text() == "mine"
    assert "b_person-2.png" in names(folder)


def test_results_are_no_shots(run: Run, shots: list[Path], tmp_path: Path) -> None:
    assert run("person", *shots)[0] == 0
    panel = tmp_path / "skinmaps" / "a_person.png"
    mark = read_mark(panel)
    assert mark is not None and (mark.verb, mark.part) == ("person", "panel")
    code, _, err = run("person", tmp_path, "--recursive")
    assert code == 0 and "2 results of skinnet (a_person.json, a_person.png)" in err
    assert "is a result of skinnet (panel), not a photograph" in run("person", panel, *shots)[2]


def test_a_folder_that_cannot_be_written_is_reported(
    run: Run, shots: list[Path], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    code, _, err = run("person", *shots, "-o", tmp_path / "file")
    assert code == 2 and "cannot be written" in err and "with -o" in err
    (tmp_path / "out" / "a_person.json").mkdir(parents=True)
    code, _, err = run("person", *shots, "-o", tmp_path / "out")
    assert code == 2 and names(tmp_path / "out") == ["a_person.json"]


def test_what_is_known_of_the_capture_is_told_of_every_shot(
    tmp_path: Path, astronaut: np.ndarray, capsys: pytest.CaptureFixture[str]
) -> None:
    photos = [tmp_path / "a.png", tmp_path / "b.png"]
    for photo, pixels in zip(photos, (astronaut, astronaut[:, ::-1]), strict=True):
        Image.fromarray(pixels).save(photo)
    arguments = ["person", *map(str, photos), "--json", "--light"]
    assert main([*arguments, "flash"]) == 0
    summary = json.loads(capsys.readouterr().out)
    known = [shot["capture_known"] for shot in summary["shots"]]
    assert known == [["light", "temperature"]] * 2
    assert main([*arguments, "flsh"]) == 2
    assert "flsh" in capsys.readouterr().err
