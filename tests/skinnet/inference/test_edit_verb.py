"""Edits of one photograph and of many, to files, folders and pipes."""

import io
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from flat_decomposer import WALL, names, paint, run, save
from PIL import Image

from skinnet.cli import main
from skinnet.images._mark import read_mark

__all__ = ["run"]
Run = Callable[..., tuple[int, str, str]]
DARK = (100, 70, 60)


def pipe(monkeypatch: pytest.MonkeyPatch, data: bytes) -> Callable[[], bytes]:
    """Standard input of some bytes; the function gives those of standard output."""
    out = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))
    monkeypatch.setattr(sys, "stdout", out)
    return lambda: out.buffer.getvalue()


def test_a_folder_is_edited_beside_its_photographs(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.jpg")
    save(tmp_path / "b.png", DARK)
    save(tmp_path / "below" / "c.tif", DARK)
    code, out, err = run("edit", tmp_path)
    assert code == 0
    assert out.splitlines() == [
        f"{tmp_path / name}.{suffix}: {tmp_path / name}_edited.{suffix}"
        for name, suffix in (("a", "jpg"), ("b", "png"))
    ]
    assert "2 photographs, 2 faces edited, 0 not edited" in err
    assert "further pictures, 1 in 1 subfolder; --recursive reads them too" in err
    assert run("edit", tmp_path, "-r")[0] == 0
    assert (tmp_path / "below" / "c_edited.tif").is_file()
    assert names(tmp_path) == ["a.jpg", "a_edited.jpg", "b.png", "b_edited.png", "below"]


def test_edits_are_no_photographs_of_a_second_run(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    assert run("edit", tmp_path)[0] == 0
    before = names(tmp_path)
    code, _, err = run("edit", tmp_path)
    assert code == 0 and names(tmp_path) == before
    assert "1 photograph, 1 face edited, 0 not edited, 1 passed over" in err
    assert "1 result of skinnet (a_edited.png)" in err


def test_several_go_to_a_folder_which_is_made(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    save(tmp_path / "below" / "a.png", DARK)
    out = tmp_path / "new" / "out"
    code, _, err = run("edit", tmp_path, "-r", "-o", out)
    assert code == 0 and names(out) == ["a_edited-2.png", "a_edited.png"]
    assert f"{out / 'a_edited.png'} is another file; the edit of" in err
    assert f"edits in {out}" in err
    assert run("edit", tmp_path, "-r", "-o", out)[0] == 0
    assert names(out) == ["a_edited-2.png", "a_edited.png"]


@pytest.mark.parametrize("made", [True, False])
def test_one_photograph_goes_to_a_folder_that_is_one(run: Run, tmp_path: Path, made: bool) -> None:
    photo = save(tmp_path / "a.png")
    (tmp_path / "out").mkdir() if made else None
    assert run("edit", photo, "-o", tmp_path / "out" if made else f"{tmp_path}/out/")[0] == 0
    assert names(tmp_path / "out") == ["a_edited.png"]


def test_what_fails_is_named_and_the_rest_is_edited(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png", WALL)
    (tmp_path / "b.png").write_bytes(save(tmp_path / "c.png").read_bytes()[:60])
    code, out, err = run("edit", tmp_path)
    assert code == 2
    assert out == f"{tmp_path / 'c.png'}: {tmp_path / 'c_edited.png'}\n"
    assert f"No face was found in {tmp_path / 'a.png'}" in err
    assert f"{tmp_path / 'b.png'} is damaged" in err
    assert (
        "1 photograph, 1 face edited, 2 not edited (1 could not be read, 1 without a face)" in err
    )
    assert names(tmp_path) == ["a.png", "b.png", "c.png", "c_edited.png"]


def test_a_file_is_for_one_photograph(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    said = "out.jpg would be one picture, and 1 photograph of a folder is edited; give a folder"
    code, _, err = run("edit", tmp_path, "-o", tmp_path / "out.jpg")
    assert code == 2 and said in err
    save(tmp_path / "b.png")
    code, _, err = run("edit", tmp_path / "a.png", tmp_path / "b.png", "-o", tmp_path / "out.jpg")
    assert code == 2 and "and 2 photographs are edited" in err
    assert names(tmp_path) == ["a.png", "b.png"]


def test_a_pipe_has_the_picture_alone(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo = save(tmp_path / "a.jpg", quality=95)
    read = pipe(monkeypatch, photo.read_bytes())
    monkeypatch.chdir(tmp_path)
    assert run("edit", "-", "-o", "-")[0] == 0
    with Image.open(io.BytesIO(read())) as image:
        assert image.format == "JPEG" and image.size == (32, 16)
    assert read_mark(io.BytesIO(read())).part == "edited"
    assert names(tmp_path) == ["a.jpg"]


def test_a_pipe_has_the_format_that_is_asked_for(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    deep = np.array(paint()).astype(np.uint16) * 257
    from imagecodecs import png_encode

    read = pipe(monkeypatch, png_encode(deep))
    code, _, err = run("edit", "-", "-o", "-", "--format", "jpeg", "--quality", 60)
    assert code == 0
    with Image.open(io.BytesIO(read())) as image:
        assert image.format == "JPEG"
    assert "standard output has 8 bits a channel, since JPEG holds no 16." in err


def test_a_pipe_takes_one_photograph(
    refused: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photos = save(tmp_path / "a.png"), save(tmp_path / "b.png", DARK)
    read = pipe(monkeypatch, b"")
    factor = "--melanin", 2
    assert "and 2 photographs are given; give a folder" in refused(
        "edit", *photos, "-o", "-", *factor
    )
    assert "leave out one of them" in refused("edit", photos[0], "-o", "-", "--json", *factor)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert "Standard output is a terminal" in refused("edit", photos[0], "-o", "-", *factor)
    assert read() == b"" and names(tmp_path) == ["a.png", "b.png"]


def test_a_pipe_that_cannot_be_written_is_said(
    refused: Callable[..., str], run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Full(io.RawIOBase):
        def writable(self) -> bool:
            return True

        def write(self, data: object) -> int:
            raise OSError(28, "No space left on device")

    photo = save(tmp_path / "a.png")
    full = io.TextIOWrapper(io.BufferedWriter(Full()), encoding="utf-8")
    monkeypatch.setattr(sys, "stdout", full)
    said = refused("edit", photo, "-o", "-", "--melanin", 2)
    assert said == (
        "skinnet: Standard output cannot be written (No space left on device); give a file with "
        "-o.\n"
    )
    with pytest.raises(OSError, match="No space"):
        full.close()


def test_formats_are_asked_for_by_name(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.JPEG")
    save(tmp_path / "b.png", DARK)
    out = tmp_path / "out"
    assert run("edit", tmp_path, "-o", out, "--format", "JPG")[0] == 0
    assert names(out) == ["a_edited.JPEG", "b_edited.jpg"]
    code, _, err = run("edit", tmp_path / "b.png", "-o", tmp_path / "c.png", "--format", "tif")
    assert code == 2 and "c.png is PNG by its ending, and --format tif is another" in err
    code, _, err = run("edit", tmp_path / "b.png", "--format", "gif")
    assert code == 2 and "got 'gif'" in err


def test_a_quality_is_written_and_checked(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.jpg", quality=90)
    sizes = []
    for quality in (20, 98):
        out = tmp_path / f"{quality}.jpg"
        assert run("edit", photo, "-o", out, "--quality", quality)[0] == 0
        sizes.append(out.stat().st_size)
    assert sizes[0] < sizes[1]
    code, _, err = run("edit", photo, "-o", tmp_path / "b.png", "--quality", 50)
    assert code == 0 and "b.png is written without loss: PNG has no quality." in err
    code, _, err = run("edit", photo, "--quality", 101)
    assert code == 2 and "from 1 to 100; got 101" in err


def test_json_has_a_line_for_each_edit(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    save(tmp_path / "b.jpg", DARK)
    code, out, _ = run("edit", tmp_path, "--json", "--quality", 70, "-o", tmp_path / "out")
    first, second = (json.loads(line) for line in out.splitlines())
    assert code == 0
    assert first["file"] == str(photo)
    assert first["input"]["path"] == "../a.png" and len(first["input"]["sha256"]) == 64
    assert first["output"] == str(tmp_path / "out" / "a_edited.png")
    assert (first["format"], first["quality"]) == ("PNG", None)
    assert (second["format"], second["quality"]) == ("JPEG", 70)
    assert first["factors"] == {"melanin": 2.0, "hemoglobin": 1.0} and first["mask"] is None
    (face,) = first["faces"]
    assert face == {
        "id": 1,
        "box": {"left": 0, "top": 0, "right": 32, "bottom": 16},
        "edited_pixels": 512,
        "colour": {"before": [0.0, 0.0, 0.0], "after": [255.0, 255.0, 255.0]},
    }
    assert first["notes"] == [
        f"{tmp_path / 'out' / 'a_edited.png'} is written without loss: PNG has no quality."
    ]


def test_a_mask_in_the_folder_is_no_photograph(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    Image.new("L", (32, 16), 255).save(tmp_path / "mask.png")
    code, _, err = run("edit", tmp_path, "--mask", tmp_path / "mask.png")
    assert code == 0 and "1 mask of the edit (mask.png)" in err
    save(tmp_path / "b.png", DARK)
    code, _, err = run("edit", tmp_path, "--mask", tmp_path / "mask.png")
    assert code == 0 and f"{tmp_path / 'mask.png'} is the mask of all 2 photographs." in err
    assert names(tmp_path) == ["a.png", "a_edited.png", "b.png", "b_edited.png", "mask.png"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "Nothing is edited with factors of 1"),
        (("--melanin", "2", "--mask", "-"), "--mask takes a file"),
        (("--melanin", "2", "--mask", "none.png"), "There is no file none.png"),
        (("--melanin", "12"), "melanin is multiplied by a number in [0, 10]; got 12"),
        (("--melanin", "2", "--quality", "0"), "from 1 to 100; got 0"),
        (("--melanin", "2", "--quality", "high"), "--quality is a whole number; got 'high'"),
    ],
)
def test_a_folder_is_refused_in_one_sentence(
    refused: Callable[..., str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: tuple[str, ...],
    words: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    save(tmp_path / "a.png")
    save(tmp_path / "b.png", DARK)
    said = refused("edit", ".", *options)
    assert words in said and said.count("\n") == 1
    assert names(tmp_path) == ["a.png", "b.png"]


def test_a_mask_weighs_the_edit_of_a_file(
    model_file: Path, tmp_path: Path, astronaut: np.ndarray, capsys: pytest.CaptureFixture[str]
) -> None:
    photo = tmp_path / "a.png"
    Image.fromarray(astronaut).save(photo)
    mask = np.zeros((512, 512), np.uint8)
    mask[:, 220:] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    options = ["--melanin", "3", "--mask", str(tmp_path / "mask.png"), "--model", str(model_file)]
    assert main(["edit", str(photo), *options, "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    edited = np.array(Image.open(tmp_path / "a_edited.png"))
    np.testing.assert_array_equal(edited[:, :220], astronaut[:, :220])
    changed = (edited != astronaut).any(-1)
    assert changed.any() and summary["mask"] == str(tmp_path / "mask.png")
    (face,) = summary["faces"]
    assert 0 < face["edited_pixels"] <= changed.sum() + 1
    assert (np.subtract(face["colour"]["before"], face["colour"]["after"]) > 0).all()
    Image.fromarray(mask[:10]).save(tmp_path / "mask.png")
    assert main(["edit", str(photo), *options]) == 2
    assert f"The mask has 512 x 10 pixels, and {photo} 512 x 512" in capsys.readouterr().err


def test_a_mask_without_skin_is_said(
    model_file: Path, tmp_path: Path, astronaut: np.ndarray, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(astronaut).save(tmp_path / "a.png")
    mask = np.zeros((512, 512), np.uint8)
    mask[-5:, -5:] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    options = ["--mask", str(tmp_path / "mask.png"), "--model", str(model_file)]
    assert main(["edit", str(tmp_path / "a.png"), "--melanin", "3", *options]) == 2
    assert "was found in it where the mask is not black" in capsys.readouterr().err
    assert names(tmp_path) == ["a.png", "mask.png"]


def test_states_are_words_that_are_known(run: Run, tmp_path: Path) -> None:
    photo = save(tmp_path / "a.png")
    for words in ((photo, "--state", "flush", "0.7"), ("--state", "flush", "0.7", photo)):
        code, out, _ = run("edit", *words, "--json")
        assert code == 0 and json.loads(out)["states"] == {"flush": 0.7}
    code, out, _ = run("edit", photo, "--json")
    assert code == 0 and json.loads(out)["states"] == {}


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("flus", "0.7"), "There is no state 'flus'; states are flush, pallor, "),
        (("flush", "1.2"), "The amount of flush is a number from 0"),
        (("flush", "-1"), "got -1"),
        (("flush", "much"), "got 'much'. Write it after the name, such as --state flush 0.7."),
        (("flush", "nan"), "got nan"),
        (("flush",), "--state needs NAME and AMOUNT after it."),
        (("flush", ".5", "--state", "flush", ".6"), "--state flush is given twice"),
        (("flush", ".5", "--region", "skin"), "leave out one of them"),
    ],
)
def test_states_that_cannot_be_are_refused(
    run: Run, tmp_path: Path, words: tuple[str, ...], sentence: str
) -> None:
    photo = save(tmp_path / "a.png")
    code, _, err = run("edit", photo, "--state", *words)
    assert code == 2 and sentence in err and names(tmp_path) == ["a.png"]


def test_a_state_alone_is_an_edit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["edit", "--state", "flush", "0.7"]) == 2
    assert "edit needs input" in capsys.readouterr().err
    assert main(["edit", str(tmp_path / "a.png"), "--melanin", "1"]) == 2
    assert "--state NAME AMOUNT" in capsys.readouterr().err
