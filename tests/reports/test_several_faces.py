"""Photographs of several people: one result a face, written together, under names of its own."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from flat_decomposer import PEOPLE, names, read_melanin, run, save

from skinnet.cli import main
from skinnet.images._mark import read_mark

__all__ = ["run"]
Run = Callable[..., tuple[int, str, str]]

FACES = [f"a_face{number}" for number in range(1, PEOPLE + 1)]


def test_every_face_has_files_and_a_line(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    code, out, err = run("predict", photo, "--faces", "all", "-o", tmp_path / "out")
    assert code == 0 and err == ""
    assert list(read_melanin(tmp_path / "out")) == [f"{face}.json" for face in FACES]
    assert len(names(tmp_path / "out")) == 15 * PEOPLE
    lines = out.splitlines()
    assert [line.startswith(f"{photo}, face {k + 1}: ") for k, line in enumerate(lines)]
    assert "15 files" in lines[2] and f"{FACES[2]}_*.png" in lines[2]


def test_json_has_a_line_a_face(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    code, out, _ = run("predict", tmp_path / "a.png", "--faces", "2", "--json")
    summaries = [json.loads(line) for line in out.splitlines()]
    assert code == 0 and [each["id"] for each in summaries] == [1, 2]
    for face, summary in zip(FACES, summaries, strict=False):
        assert summary == json.loads((tmp_path / "skinmaps" / f"{face}.json").read_text())


@pytest.mark.parametrize("faces", ["largest", "1"])
def test_a_single_face_has_the_name_of_the_photograph(run: Run, tmp_path: Path, faces: str) -> None:
    assert run("predict", save(tmp_path / "a.png"), "--faces", faces)[0] == 0
    assert list(read_melanin(tmp_path / "skinmaps")) == ["a.json"]


@pytest.mark.parametrize("faces", ["0", "-2", "two", "1.5", ""])
@pytest.mark.parametrize("verb", ["predict", "edit"])
def test_other_words_are_refused(run: Run, tmp_path: Path, verb: str, faces: str) -> None:
    code, out, err = run(verb, save(tmp_path / "a.png"), f"--faces={faces}")
    assert code == 2 and out == ""
    assert "faces is all, largest, or how many of the largest, from 1; got" in err
    assert names(tmp_path) == ["a.png"]


def test_a_second_run_replaces_its_own_results(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    for faces in ("all", "all", "largest", "2", "all"):
        assert run("predict", tmp_path, "--faces", faces, "-o", tmp_path)[0] == 0
    assert list(read_melanin(tmp_path)) == ["a.json", *(f"{face}.json" for face in FACES)]
    assert len(names(tmp_path)) == 1 + 15 * (1 + PEOPLE)
    for path in tmp_path.glob("a_face*.png"):
        mark = read_mark(path)
        assert mark is not None and mark.verb == "predict"


@pytest.mark.parametrize("group_first", [True, False])
def test_a_photograph_with_such_a_name_keeps_its_results(
    run: Run, tmp_path: Path, group_first: bool
) -> None:
    group = save(tmp_path / "a.png", (100, 80, 70))
    other = save(tmp_path / "a_face2.png", (180, 120, 100))
    out = tmp_path / "out"
    jobs = [[group, "--faces", "all"], [other]]
    for _ in range(2):
        for job in jobs if group_first else jobs[::-1]:
            code, _, err = run("predict", *job, "-o", out)
            assert code == 0 and len(err.splitlines()) <= 1
    group_stem, other_stem = ("a", "a_face2-2") if group_first else ("a-2", "a_face2")
    expected = {f"{group_stem}_face{k}.json": 0.1 for k in range(1, PEOPLE + 1)}
    assert read_melanin(out) == expected | {f"{other_stem}.json": 0.18}
    assert "are numbered: " in err or group_first


def test_a_copy_in_another_folder_has_its_own_results(run: Run, tmp_path: Path) -> None:
    first = save(tmp_path / "1" / "a.png")
    (tmp_path / "2").mkdir()
    second = shutil.copy(first, tmp_path / "2")
    for photo in (first, second, first):
        assert run("predict", photo, "--faces", "all", "-o", tmp_path / "out")[0] == 0
    numbered = [face.replace("a_", "a-2_") for face in FACES]
    assert sorted(read_melanin(tmp_path / "out")) == sorted(f"{x}.json" for x in FACES + numbered)


def test_all_faces_are_written_or_none(run: Run, tmp_path: Path) -> None:
    photo, out = save(tmp_path / "a.png"), tmp_path / "out"
    (out / f"{FACES[2]}.json").mkdir(parents=True)
    code, _, err = run("predict", photo, "--faces", "all", "-o", out)
    assert code == 2 and f"{FACES[2]}.json is a folder" in err
    assert names(out) == [f"{FACES[2]}.json"]


def test_results_of_faces_are_no_photographs(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    for _ in range(2):
        code, _, err = run("predict", tmp_path, "--faces", "all", "-o", tmp_path)
        assert code == 0
    assert f"1 photograph, {PEOPLE} faces read, 0 not read, {15 * PEOPLE} passed over" in err
    code, _, err = run("predict", tmp_path / f"{FACES[0]}_mask.png", "-o", tmp_path)
    assert code == 2 and "is a result of skinnet" in err


def test_the_help_names_the_options(capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("predict", "edit"):
        assert main([verb, "--help"]) == 0
        out = " ".join(capsys.readouterr().out.split())
        assert "--faces all|largest|N" in out and "--region {face,skin}" in out
