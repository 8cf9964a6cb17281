"""What skinnet has written is never taken for a photograph."""

import io
import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from flat_decomposer import SKIN, names, paint, read_melanin, run, save, strip_marks
from PIL import Image, PngImagePlugin

from skinnet import __version__

__all__ = ["run"]
Run = Callable[..., tuple[int, str, str]]

PARTS = (
    *("hemoglobin", "mask", "melanin", "offset_b", "offset_g", "offset_r", "panel"),
    *("hemoglobin_colour", "melanin_colour"),
    *("reconstruction", "shading", "specular", "hemoglobin_sd", "melanin_sd"),
)
FILES = sorted(["a.png", "a.json", *(f"a_{part}.png" for part in PARTS)])


@pytest.mark.parametrize("options", [[], ["--recursive"], ["--json"]])
def test_a_folder_that_is_written_into_is_read_as_before(
    run: Run, tmp_path: Path, options: list[str]
) -> None:
    save(tmp_path / "a.png")
    for _ in range(3):
        code, _, err = run("predict", tmp_path, "-o", tmp_path, *options)
        assert code == 0
        assert names(tmp_path) == FILES
        assert read_melanin(tmp_path) == {"a.json": 0.2}
    assert "1 photograph, 1 face read, 0 not read, 15 passed over" in err
    assert "15 results of skinnet" in err


def test_results_beside_photographs_are_no_photographs_of_a_subfolder(
    run: Run, tmp_path: Path
) -> None:
    save(tmp_path / "g" / "a.png")
    assert run("predict", tmp_path / "g")[0] == 0
    code, _, err = run("predict", tmp_path / "g")
    assert code == 0 and "subfolder" not in err
    assert run("predict", tmp_path / "g", "-r")[0] == 0
    assert sorted(path.name for path in tmp_path.rglob("*.json")) == ["a.json"]
    code, _, err = run("predict", tmp_path / "g" / "skinmaps")
    assert code == 2 and "holds no photographs" in err and "15 results of skinnet" in err


@pytest.mark.parametrize("spelling", ["*", "*.png", "a_*.png", "**/*", "[a-z]*"])
def test_results_that_a_pattern_matches_are_passed_over(
    run: Run, tmp_path: Path, spelling: str
) -> None:
    save(tmp_path / "a.png")
    save(tmp_path / "a_b.png", (100, 80, 70))
    run("predict", tmp_path, "-o", tmp_path)
    before = read_melanin(tmp_path)
    assert before == {"a.json": 0.2, "a_b.json": 0.1}
    code, _, err = run("predict", tmp_path / spelling, "-o", tmp_path)
    assert code == 0 and "results of skinnet" in err
    assert read_melanin(tmp_path) == before


@pytest.mark.parametrize("expanded", [True, False])
def test_a_star_names_the_folder_of_results_too(
    run: Run, tmp_path: Path, expanded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save(tmp_path / "a.png")
    for _ in range(2):
        inputs = names(tmp_path) if expanded else ["*"]
        code, _, err = run("predict", *inputs)
        assert code == 0, err
    assert "1 photograph, 1 face read, 0 not read, 15 passed over" in err
    assert read_melanin(tmp_path / "skinmaps") == {"a.json": 0.2}


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("verb", ["predict", "edit"])
def test_a_result_that_is_named_is_refused(run: Run, tmp_path: Path, part: str, verb: str) -> None:
    run("predict", save(tmp_path / "a.png"), "-o", tmp_path)
    code, out, err = run(verb, tmp_path / f"a_{part}.png")
    assert code == 2 and out == ""
    assert f"a_{part}.png is a result of skinnet" in err and "give the photograph" in err
    assert names(tmp_path) == FILES


def test_a_result_that_is_piped_in_is_refused(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run("predict", save(tmp_path / "a.png"), "-o", tmp_path)
    data = (tmp_path / "a_mask.png").read_bytes()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
    code, _, err = run("predict", "-", "-o", tmp_path)
    assert code == 2 and "standard input is a result of skinnet (map)" in err


def test_results_of_earlier_versions_are_known_too(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    run("predict", tmp_path, "-o", tmp_path / "out")
    strip_marks(tmp_path / "out")
    for path in (tmp_path / "out").iterdir():
        shutil.copy(path, tmp_path)
    code, _, err = run("predict", tmp_path, "-o", tmp_path / "new")
    assert code == 0 and "1 photograph, 1 face read, 0 not read, 13 passed over" in err
    assert read_melanin(tmp_path / "new") == {"a.json": 0.2}


@pytest.mark.parametrize("name", ["a_mask.png", "a_panel.png", "a_edited.png", "a_melanin.png"])
def test_photographs_with_such_names_are_photographs(run: Run, tmp_path: Path, name: str) -> None:
    info = PngImagePlugin.PngInfo()
    info.add_text("Software", "GIMP 2.10.36")
    info.add_text("scale", "2")
    save(tmp_path / name, pnginfo=info)
    (tmp_path / "a.json").write_text('{"file": "a.png", "labels": []}')
    code, _, err = run("predict", tmp_path, "-o", tmp_path / "out")
    assert code == 0 and "1 photograph, 1 face read, 0 not read, 1 passed over" in err
    assert read_melanin(tmp_path / "out") == {f"{name[:-4]}.json": 0.2}


@pytest.mark.parametrize("end", ["png", "jpg"])
def test_an_edited_photograph_is_read_only_where_it_alone_is_named(
    run: Run, tmp_path: Path, end: str
) -> None:
    photo = save(tmp_path / f"a.{end}")
    edited = tmp_path / f"b_edited.{end}"
    assert run("edit", photo, "-o", edited)[0] == 0
    out = tmp_path / "out"
    for inputs in ([tmp_path], [tmp_path / f"*.{end}"], [photo, edited]):
        code, _, err = run("predict", *inputs, "-o", out)
        assert code == 0 and "1 photograph, 1 face read, 0 not read, 1 passed over" in err
        assert f"1 result of skinnet (b_edited.{end})" in err
        assert list(read_melanin(out)) == ["a.json"]
    code, _, err = run("predict", edited, "-o", out)
    assert code == 0 and "b_edited" in err and "was edited by skinnet" in err
    assert list(read_melanin(out)) == ["a.json", "b_edited.json"]
    notes = json.loads((out / "b_edited.json").read_text())["notes"]
    assert any("was edited by skinnet" in note for note in notes)
    code, _, err = run("edit", edited)
    assert code == 0 and "was edited by skinnet" in err


@pytest.mark.parametrize(
    "format_", ["JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "HEIF"]
)
def test_edits_in_every_format_are_known(run: Run, tmp_path: Path, format_: str) -> None:
    if format_ == "HEIF":
        pillow_heif = pytest.importorskip("pillow_heif")
        pillow_heif.from_pillow(paint().resize((64, 32), 0)).save(tmp_path / "a.heic")
    else:
        save(tmp_path / "a", format_=format_)
    (photo,) = tmp_path.iterdir()
    assert run("edit", photo)[0] == 0
    (edited,) = (path for path in tmp_path.iterdir() if path != photo)
    renamed = edited.rename(tmp_path / "b")
    code, _, err = run("predict", tmp_path, "-o", tmp_path / "out")
    assert (
        code == 0
        and "1 photograph, 1 face read, 0 not read, 1 passed over" in err
        and "1 result of skinnet (b)" in err
    )
    assert list(read_melanin(tmp_path / "out")) == ["a.json"]
    assert run("edit", photo, "-o", edited)[0] == run("edit", photo, "-o", edited)[0] == 0
    assert renamed.read_bytes() == edited.read_bytes()


def test_results_say_who_wrote_them(run: Run, tmp_path: Path) -> None:
    run("predict", save(tmp_path / "a.png", SKIN), "-o", tmp_path)
    for path in tmp_path.glob("a_*.png"):
        with Image.open(path) as image:
            assert image.text["Software"] == f"skinnet {__version__}"
            assert image.text["skinnet"].startswith(f"skinnet {__version__} predict ")
