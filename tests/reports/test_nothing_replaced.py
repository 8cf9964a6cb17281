"""No result of another input and no file of the user is replaced."""

import io
import json
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from flat_decomposer import names, read_melanin, run, save, strip_marks

from skinnet.images._mark import EDITED, read_mark

__all__ = ["run"]
Run = Callable[..., tuple[int, str, str]]

DARK = (100, 70, 60)
"""A colour that is read as melanin 0.100."""


def snapshot(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_two_runs_into_one_folder_keep_both_and_find_their_own_again(
    run: Run, tmp_path: Path
) -> None:
    one, other = save(tmp_path / "1" / "a.png"), save(tmp_path / "2" / "a.png", DARK)
    out = tmp_path / "out"
    for _ in range(2):
        assert run("predict", one, "-o", out)[0] == 0
        code, printed, err = run("predict", other, "-o", out)
        assert code == 0 and "a-2.json" in printed and "numbered: a-2" in err
    assert read_melanin(out) == {"a.json": 0.2, "a-2.json": 0.1}
    assert len(names(out)) == 30
    record = json.loads((out / "a-2.json").read_text())
    assert record["file"] == str(other)
    assert record["input"]["path"] == "../2/a.png"
    assert len(record["input"]["sha256"]) == 64


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ("a.png", "a.jpg", {"a.json", "a-2.json"}),
        ("a.png", "A.jpg", {"a.json", "A-2.json"}),
        ("é.png", "É.jpg", {"é.json", "É-2.json"}),
        ("x/a.png", "y/a.png", {"a.json", "a-2.json"}),
        ("a.png", "a-2.png", {"a.json", "a-2.json"}),
        ("a", "a.jpg", {"a.json", "a-2.json"}),
    ],
)
@pytest.mark.parametrize("together", [True, False])
def test_equal_names_are_numbered(
    run: Run, tmp_path: Path, first: str, second: str, expected: set[str], together: bool
) -> None:
    files = [save(tmp_path / first, format_="PNG"), save(tmp_path / second, DARK)]
    for inputs in [files] if together else [[files[0]], [files[1]]]:
        assert run("predict", *inputs, "-o", tmp_path / "out")[0] == 0
    assert set(read_melanin(tmp_path / "out")) == expected
    assert sorted(round(each, 1) for each in read_melanin(tmp_path / "out").values()) == [0.1, 0.2]


def test_copies_are_two_inputs(run: Run, tmp_path: Path) -> None:
    one = save(tmp_path / "1" / "a.png")
    (tmp_path / "2").mkdir()
    shutil.copy(one, tmp_path / "2" / "a.png")
    assert run("predict", tmp_path, "-r", "-o", tmp_path / "out")[0] == 0
    assert set(read_melanin(tmp_path / "out")) == {"a.json", "a-2.json"}


def test_another_photograph_of_the_same_path_is_another_input(run: Run, tmp_path: Path) -> None:
    photo, out = tmp_path / "upload.png", tmp_path / "out"
    for colour in ((200, 140, 120), DARK):
        save(photo, colour)
        assert run("predict", photo, "-o", out)[0] == 0
    assert read_melanin(out) == {"upload.json": 0.2, "upload-2.json": 0.1}


def test_a_moved_folder_finds_its_results(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "g" / "a.png")
    assert run("predict", tmp_path / "g")[0] == 0
    (tmp_path / "g").rename(tmp_path / "h")
    assert run("predict", tmp_path / "h")[0] == 0
    assert list(read_melanin(tmp_path / "h" / "skinmaps")) == ["a.json"]


def test_another_spelling_is_the_same_input(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save(tmp_path / "g" / "a.png")
    (tmp_path / "link").symlink_to("g")
    for path in ("g/a.png", "./g/../g/a.png", tmp_path / "g" / "a.png", "link/a.png"):
        assert run("predict", path, "-o", "out")[0] == 0
    assert list(read_melanin(tmp_path / "out")) == ["a.json"]


def test_standard_input_is_known_by_its_content(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = save(tmp_path / "a.png"), save(tmp_path / "b.png", DARK)
    for path in (*files, *files):
        data = path.read_bytes()
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
        assert run("predict", "-", "-o", tmp_path / "out")[0] == 0
    assert read_melanin(tmp_path / "out") == {"stdin.json": 0.2, "stdin-2.json": 0.1}


@pytest.mark.parametrize(
    "name", ["a_mask.png", "a_panel.png", "A_MASK.PNG", "a.json", "a.JSON", "a_melanin.png"]
)
@pytest.mark.parametrize("kind", ["photograph", "text", "empty", "link", "broken link"])
def test_files_of_the_user_stay(run: Run, tmp_path: Path, name: str, kind: str) -> None:
    photo, out = save(tmp_path / "a.png"), tmp_path / "out"
    out.mkdir()
    if kind == "photograph":
        save(out / name, DARK, "PNG")
    elif kind == "link":
        (out / name).symlink_to(save(tmp_path / "mine.png", DARK))
    elif kind == "broken link":
        (out / name).symlink_to("nowhere")
    else:
        (out / name).write_text('{"mine": 1}' if kind == "text" else "")
    before, link = snapshot(out), (out / name).is_symlink()
    for _ in range(2):
        assert run("predict", photo, "-o", out)[0] == 0
    after = snapshot(out)
    assert {key: after[key] for key in before} == before
    assert (out / name).is_symlink() == link
    assert len(after) == 15 + len(before)
    assert json.loads(after["a-2.json"])["maps"]["melanin"]["mean"] == pytest.approx(0.2)


def test_a_file_put_among_the_results_stays(run: Run, tmp_path: Path) -> None:
    photo, out = save(tmp_path / "a.png"), tmp_path / "out"
    run("predict", photo, "-o", out)
    mine = save(out / "a_mask.png", DARK).read_bytes()
    code, _, err = run("predict", photo, "-o", out)
    assert code == 0 and "numbered: a-2" in err
    assert (out / "a_mask.png").read_bytes() == mine


def test_the_input_is_never_replaced(run: Run, tmp_path: Path) -> None:
    for name in ("a.png", "a_mask.png", "a_panel.png"):
        save(tmp_path / name)
    before = snapshot(tmp_path)
    assert run("predict", tmp_path, "-o", tmp_path)[0] == 0
    after = snapshot(tmp_path)
    assert {key: after[key] for key in before} == before
    assert set(read_melanin(tmp_path)) == {"a-2.json", "a_mask.json", "a_panel.json"}


@pytest.mark.parametrize("other", [True, False])
def test_results_of_earlier_versions_beside_a_photograph(
    run: Run, tmp_path: Path, other: bool
) -> None:
    """They lie in skinmaps beside it, and are replaced; elsewhere their input is unknown."""
    photo = save(tmp_path / "g" / "a.png")
    out = tmp_path / ("other" if other else "g/skinmaps")
    run("predict", photo, "-o", out)
    strip_marks(out)
    for path in out.glob("*.json"):
        path.write_text(json.dumps(json.loads(path.read_text()) | {"file": "g/a.png"}))
    assert run("predict", photo, "-o", out)[0] == 0
    assert set(read_melanin(out)) == ({"a.json", "a-2.json"} if other else {"a.json"})


def test_a_failed_run_leaves_what_was_there(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, out = save(tmp_path / "a.png"), tmp_path / "out"
    run("predict", photo, "-o", out)
    before = snapshot(out)

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("skinnet.inference.results.write_text", fail)
    code, _, err = run("predict", photo, "-o", out)
    assert code == 2 and "No space left on device" in err
    assert snapshot(out) == before


@pytest.mark.parametrize("kind", ["photograph", "other edit", "text", "link to the photograph"])
def test_an_edit_takes_another_name_or_is_refused(run: Run, tmp_path: Path, kind: str) -> None:
    photo, taken = save(tmp_path / "a.png"), tmp_path / "a_edited.png"
    if kind == "photograph":
        save(taken, DARK)
    elif kind == "other edit":
        assert run("edit", save(tmp_path / "b.png", DARK), "-o", taken)[0] == 0
    elif kind == "text":
        taken.write_text("mine")
    else:
        taken.symlink_to(photo)
    before = taken.read_bytes()
    code, _, err = run("edit", photo, "-o", taken)
    assert code == 2 and "a_edited.png" in err and "choose another file with -o" in err
    for _ in range(2):
        code, out, _ = run("edit", photo)
        assert code == 0 and "a_edited-2.png" in out
    assert taken.read_bytes() == before
    assert names(tmp_path).count("a_edited-2.png") == 1 and "a_edited-3.png" not in names(tmp_path)


def test_an_edit_of_the_same_photograph_is_replaced(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    for _ in range(2):
        assert run("edit", photo)[0] == 0
        assert run("edit", photo, "-o", tmp_path / "b.png")[0] == 0
    assert names(tmp_path) == ["a.png", "a_edited.png", "b.png"]
    mark = read_mark(tmp_path / "b.png")
    assert mark is not None and mark.part == EDITED


@pytest.mark.parametrize("spelling", ["a.png", "./a.png", "link.png", "hard.png", "g/../a.png"])
def test_an_edit_never_replaces_its_input(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, spelling: str
) -> None:
    monkeypatch.chdir(tmp_path)
    photo = save(tmp_path / "a.png")
    (tmp_path / "g").mkdir()
    (tmp_path / "link.png").symlink_to("a.png")
    os.link(photo, tmp_path / "hard.png")
    before = photo.read_bytes()
    code, _, err = run("edit", "a.png", "-o", spelling)
    assert code == 2 and "is the photograph itself" in err
    assert photo.read_bytes() == before
    assert (tmp_path / "link.png").is_symlink()


def test_an_edit_of_an_edit_takes_a_name_of_its_own(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    run("edit", photo)
    before = (tmp_path / "a_edited.png").read_bytes()
    assert run("edit", tmp_path / "a_edited.png")[0] == 0
    code, _, err = run("edit", tmp_path / "a_edited.png", "-o", tmp_path / "a_edited.png")
    assert code == 2 and "is the photograph itself" in err
    assert (tmp_path / "a_edited.png").read_bytes() == before
    assert names(tmp_path) == ["a.png", "a_edited.png", "a_edited_edited.png"]
