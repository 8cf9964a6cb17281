import io
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet import __version__, cli
from skinnet.cli import main
from skinnet.inference._colour_scales import MELANIN

MAPS = [
    *("hemoglobin", "mask", "melanin", "offset_b", "offset_g", "offset_r", "shading", "specular"),
    *("hemoglobin_sd", "melanin_sd", "hemoglobin_colour", "melanin_colour"),
]
FILES = sorted([*(f"a_{name}.png" for name in (*MAPS, "panel", "reconstruction")), "a.json"])

Predict = Callable[..., int]


@pytest.fixture
def photo(tmp_path: Path, astronaut: np.ndarray) -> Path:
    """The astronaut in warm light: the tiny model takes the wall for skin."""
    path = tmp_path / "a.png"
    warm = astronaut[:256, 96:352] * np.array([1, 0.95, 0.85])
    Image.fromarray(warm.astype(np.uint8)).save(path)
    return path


@pytest.fixture
def predict(model_file: Path) -> Predict:
    return lambda *arguments: main(["predict", *map(str, arguments), "--model", str(model_file)])


@pytest.fixture
def edit(model_file: Path) -> Predict:
    return lambda *arguments: main(["edit", *map(str, arguments), "--model", str(model_file)])


READ, EDIT = ["predict"], ["edit", "--melanin", "2"]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def pixels(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.array(image)


def test_predict_writes_beside_the_photograph(
    predict: Predict, photo: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert predict(photo) == 0
    assert names(photo.parent / "skinmaps") == FILES
    out, err = capsys.readouterr()
    assert out.startswith(f"{photo}: melanin ") and "15 files" in out and len(out.split("\n")) == 2
    assert err == ""


def test_maps_say_what_their_pixels_mean(predict: Predict, photo: Path, tmp_path: Path) -> None:
    assert predict(photo, "-o", tmp_path / "out") == 0
    summary = json.loads((tmp_path / "out" / "a.json").read_text())
    with Image.open(tmp_path / "out" / "a_melanin.png") as image:
        note = image.text
        values = float(note["scale"]) * np.array(image) + float(note["offset"])
    skin = pixels(tmp_path / "out" / "a_mask.png") > 0.501 * 65535
    assert note["unit"] == "melanosome volume fraction"
    assert values[skin].mean() == pytest.approx(summary["maps"]["melanin"]["mean"], rel=1e-3)


def test_maps_are_exactly_0_outside_of_the_mask_and_say_so(
    predict: Predict, photo: Path, tmp_path: Path
) -> None:
    assert predict(photo, "-o", tmp_path / "out") == 0
    summary = json.loads((tmp_path / "out" / "a.json").read_text())
    assert summary["map_files"]["outside_mask"] == 0
    assert summary["map_files"]["mask_above"] == 0.5
    skin = pixels(tmp_path / "out" / "a_mask.png") > 0.501 * 65535
    assert 0.2 < skin.mean() < 0.9
    for name in MAPS[:-2]:
        with Image.open(tmp_path / "out" / f"a_{name}.png") as image:
            note = image.text
            values = float(note["scale"]) * np.array(image) + float(note["offset"])
        assert (name == "mask") == ("outside_mask" not in note)
        assert name == "mask" or (values[~skin] == 0).mean() > 0.999


def test_maps_in_colour_are_on_the_panels_scale(
    predict: Predict, photo: Path, tmp_path: Path
) -> None:
    assert predict(photo, "-o", tmp_path / "out") == 0
    summary = json.loads((tmp_path / "out" / "a.json").read_text())
    scale = summary["map_files"]["colour"]["melanin"]
    assert (scale["ticks"][-1], scale["unit"], scale["linear_to"]) == (50, "%", 1)
    with Image.open(tmp_path / "out" / "a_melanin_colour.png") as image:
        assert image.text["skinnet"].split()[3] == "colour"
        assert image.text["colour_scale"].startswith(
            "melanosomes in the epidermis, by volume: 0 to"
        )
        colours = np.array(image.convert("RGB"))
    with Image.open(tmp_path / "out" / "a_melanin.png") as image:
        values = float(image.text["scale"]) * np.array(image) + float(image.text["offset"])
    skin = pixels(tmp_path / "out" / "a_mask.png") > 0.501 * 65535
    off = np.abs(colours[skin].astype(int) - MELANIN.colour(values[skin]))
    assert colours.shape[:2] == skin.shape and off.max() <= 2
    grey = np.array([int(scale["outside_mask"][at : at + 2], 16) for at in (1, 3, 5)])
    assert (colours[~skin] == grey).all(-1).mean() > 0.999


@pytest.mark.parametrize(
    ("which", "coloured"),
    [("none", []), ("all", ["hemoglobin", "melanin", "shading", "specular"])],
)
def test_which_maps_are_in_colour_can_be_chosen(
    predict: Predict, photo: Path, tmp_path: Path, which: str, coloured: list[str]
) -> None:
    assert predict(photo, "-o", tmp_path / "out", "--colour-maps", which) == 0
    found = [name for name in names(tmp_path / "out") if "_colour" in name]
    assert found == [f"a_{name}_colour.png" for name in coloured]


def test_maps_are_soft_on_request(predict: Predict, photo: Path, tmp_path: Path) -> None:
    assert predict(photo, "-o", tmp_path / "fine") == 0
    assert predict(photo, "--no-detail", "-o", tmp_path / "soft") == 0
    fine, soft = (pixels(tmp_path / kind / "a_shading.png") for kind in ("fine", "soft"))
    assert fine.shape == soft.shape == (256, 256)
    assert np.abs(np.diff(fine / 65535)).mean() > np.abs(np.diff(soft / 65535)).mean()


def test_json_alone_goes_to_standard_output(
    predict: Predict, photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert predict(photo, photo, "--json", "-o", tmp_path / "out") == 0
    (line,) = capsys.readouterr().out.splitlines()
    first = json.loads(line)
    assert first["file"] == str(photo)
    assert first == json.loads((tmp_path / "out" / "a.json").read_text())


def test_the_terminal_states_the_intervals_of_the_summary(
    predict: Predict, photo: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert predict(photo) == 0
    out = capsys.readouterr().out
    summary = json.loads((photo.parent / "skinmaps" / "a.json").read_text())
    for name, each in summary["pigments"].items():
        low, high = each["interval"]
        assert each["level"] == 0.9
        mean, low, high = (f"{100 * number:.2g}" for number in (each["mean"], low, high))
        assert f"{name} {mean} % (90 %: {low} to {high}" in out


def test_no_skin_is_null_and_reported(
    skinless_file: Path, photo: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["predict", str(photo), "--model", str(skinless_file)]) == 0
    assert "no skin was found" in capsys.readouterr().out
    summary = json.loads((photo.parent / "skinmaps" / "a.json").read_text())
    assert summary["maps"]["melanin"]["mean"] is None


def test_equal_stems_do_not_overwrite_each_other(
    predict: Predict, photo: Path, tmp_path: Path
) -> None:
    Image.open(photo).convert("RGB").save(tmp_path / "A.jpg")
    out = tmp_path / "out"
    assert predict(photo, tmp_path / "A.jpg", photo, "-o", out) == 0
    summaries = {
        name: json.loads((out / name).read_text()) for name in names(out) if "json" in name
    }
    assert {name: summary["file"] for name, summary in summaries.items()} == {
        "a.json": str(photo),
        "A-2.json": str(tmp_path / "A.jpg"),
    }


def test_a_folder_goes_on_after_a_bad_file(
    predict: Predict, photo: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = photo.parent
    (folder / "0.jpg").write_bytes(b"")
    (folder / "b.png").write_bytes(photo.read_bytes()[:5000])
    (folder / "notes.txt").write_text("not looked at")
    (folder / "z.jpg").mkdir()
    assert predict(folder) == 2
    assert names(folder / "skinmaps") == FILES
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 1
    empty, truncated, count = err.splitlines()
    assert empty.startswith(f"skinnet: {folder / '0.jpg'} is empty")
    assert truncated.startswith(f"skinnet: {folder / 'b.png'} is damaged or cut short")
    assert count.startswith("skinnet: 1 photograph, 1 face read, 2 not read, 1 passed over, ")
    where = folder / "skinmaps"
    assert count.endswith(f": maps in {where}. Passed over: 1 other file (notes.txt).")


def test_a_list_goes_on_after_a_bad_file(
    predict: Predict, photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty").mkdir()
    assert predict(tmp_path / "no.jpg", tmp_path / "empty", photo) == 2
    missing, empty, count = capsys.readouterr().err.splitlines()
    assert missing == f"skinnet: There is no file {tmp_path / 'no.jpg'}; check the path."
    assert empty.startswith(f"skinnet: The folder {tmp_path / 'empty'} holds no photographs; they")
    assert count.startswith("skinnet: 1 photograph, 1 face read, 2 not read, ")
    assert names(tmp_path / "skinmaps") == FILES


def test_faces_that_cannot_be_read_do_not_stop_a_run(
    predict: Predict,
    photo: Path,
    tmp_path: Path,
    astronaut: np.ndarray,
    capsys: pytest.CaptureFixture[str],
) -> None:
    Image.fromarray(astronaut).resize((96, 96)).save(tmp_path / "small.png")
    Image.fromarray(astronaut[200:]).save(tmp_path / "suit.png")
    assert predict(tmp_path, "--json", "--faces", "all") == 2
    out, err = capsys.readouterr()
    (summary,) = (json.loads(line) for line in out.splitlines())
    assert summary["file"] == str(photo) and summary["id"] == summary["faces_found"] == 1
    assert f"The face in {tmp_path / 'small.png'} is 2" in err and "and 24 are needed" in err
    assert f"No face was found in {tmp_path / 'suit.png'}" in err
    assert "1 photograph, 1 face read, 2 not read (1 could not be read, 1 without a face), " in err


def test_without_a_face_the_option_is_named(
    predict: Predict, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wall = tmp_path / "wall.png"
    Image.new("RGB", (80, 60), "bisque").save(wall)
    assert predict(wall) == 2
    assert names(tmp_path) == ["wall.png"]
    assert f"No face was found in {wall}" in (err := capsys.readouterr().err)
    assert "--region skin" in err
    assert predict(wall, "--whole-image") == 0


def test_standard_input_is_a_photograph(
    predict: Predict, photo: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        sys, "stdin", io.TextIOWrapper(io.BytesIO(photo.read_bytes()), encoding="utf-8")
    )
    assert predict("-") == 0
    assert "stdin_panel.png" in names(tmp_path / "skinmaps")
    assert (
        json.loads((tmp_path / "skinmaps" / "stdin.json").read_text())["file"] == "standard input"
    )


@pytest.mark.parametrize("verb", [READ, EDIT])
def test_empty_standard_input_is_reported(
    verb: list[str],
    model_file: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b""), encoding="utf-8"))
    assert main([*verb, "-", "--model", str(model_file)]) == 2
    assert (
        capsys.readouterr().err
        == "skinnet: standard input is empty (0 bytes); was it copied completely?\n"
    )


def test_a_folder_that_cannot_be_written_is_reported(
    predict: Predict, photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    before = names(tmp_path)
    assert predict(photo, "-o", tmp_path / "file" / "out") == 2
    assert predict(photo, "-o", tmp_path / "file") == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert all("cannot be written" in line and "with -o" in line for line in lines)
    assert names(tmp_path) == before


def test_a_file_that_cannot_be_written_takes_the_others_with_it(
    predict: Predict, photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out" / "a.json").mkdir(parents=True)
    assert predict(photo, "-o", tmp_path / "out") == 2
    assert "a.json is a folder" in capsys.readouterr().err
    assert names(tmp_path / "out") == ["a.json"]


@pytest.mark.parametrize("verb", [READ, EDIT])
def test_a_bad_model_is_reported_once(
    verb: list[str], photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad.onnx").write_bytes(b"bad")
    assert main([*verb, str(photo), "--model", str(tmp_path / "bad.onnx")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"skinnet: {tmp_path / 'bad.onnx'} is not a complete ONNX file")
    assert names(tmp_path) == ["a.png", "bad.onnx"]


@pytest.mark.parametrize("verb", [READ, EDIT])
def test_an_unknown_light_is_answered_with_simple_words(
    verb: list[str], photo: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*verb, str(photo), "--light", "sunny", "--model", str(model_file)]) == 2
    assert capsys.readouterr().err == (
        "skinnet: There is no light of the name 'sunny'. Give daylight, flash, tungsten, or the "
        "temperature of daylight, such as D65 or 5500K (in Python by Capture.from_names), or a "
        "light of the model: D, A.\n"
    )
    assert names(photo.parent) == ["a.png"]


def test_edit_keeps_what_is_not_skin(edit: Predict, photo: Path, tmp_path: Path) -> None:
    assert edit(photo, "--melanin", "2") == 0
    before, after = pixels(photo), pixels(tmp_path / "a_edited.png")
    same = (before == after).all(-1)
    assert 0.2 < same.mean() < 0.9
    assert (after[~same].astype(int) <= before[~same]).all()


def test_edit_says_what_the_format_cannot_hold(
    edit: Predict, photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut_out = np.dstack([pixels(photo), np.zeros((256, 256), np.uint8)])
    cut_out[:, 20:, 3] = 255
    Image.fromarray(cut_out).save(photo)
    assert edit(photo, "--melanin", "2") == 0
    assert capsys.readouterr().err == ""
    np.testing.assert_array_equal(pixels(tmp_path / "a_edited.png")[..., 3], cut_out[..., 3])
    assert edit(photo, "--melanin", "2", "-o", tmp_path / "b.jpg") == 0
    said = f"{tmp_path / 'b.jpg'} is blended with white, since JPEG holds no transparency."
    assert capsys.readouterr().err == f"skinnet: {said}\n"


@pytest.mark.parametrize("suffix", [".jpg", ".JPEG", ".png", ".tif", ".webp"])
def test_edit_writes_the_format_that_is_asked_for(
    edit: Predict, photo: Path, tmp_path: Path, suffix: str
) -> None:
    target = tmp_path / f"b{suffix}"
    assert edit(photo, "--hemoglobin", "2", "-o", target) == 0
    with Image.open(target) as image:
        formats = {".png": "PNG", ".tif": "TIFF", ".webp": "WEBP"}
        assert image.format == formats.get(suffix, "JPEG")
        assert image.size == (256, 256)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["-o", "b.gif"],
            "b.gif has to end in .jpg, .png, .tif, .webp, ",
        ),
        (
            ["-o", "b"],
            "b has no ending that names a format, such as .jpg or .png; if it is to be a",
        ),
        (["-o", "a.png"], "a.png is the photograph itself; choose another file with -o"),
        (["-o", "./a.png"], "is the photograph itself"),
        (["-o", "none/b.png"], "none/b.png cannot be written, since there is no folder none; make"),
        (["--melanin", "nan"], "melanin is multiplied by a number in [0, 10]; got nan"),
        (["--hemoglobin", "-1"], "hemoglobin is multiplied by a number in [0, 10]; got -1"),
        (["--melanin", "11"], "got 11"),
    ],
)
def test_edit_refuses_in_a_sentence(
    edit: Predict,
    photo: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    words: str,
) -> None:
    monkeypatch.chdir(photo.parent)
    before = photo.read_bytes()
    options = options if "--melanin" in options else ["--melanin", "2", *options]
    assert edit("a.png", *options) == 2
    assert words in capsys.readouterr().err
    assert names(photo.parent) == ["a.png"] and photo.read_bytes() == before


@pytest.mark.parametrize("factors", [[], ["--melanin", "1"], ["--hemoglobin", "1.0"]])
def test_an_edit_that_changes_nothing_keeps_the_one_before(
    edit: Predict,
    photo: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    factors: list[str],
) -> None:
    assert edit(photo, "--melanin", "2") == 0
    before = (tmp_path / "a_edited.png").read_bytes()
    capsys.readouterr()
    assert edit(photo, *factors) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("skinnet: Nothing is edited with factors of 1; give --melanin X, ")
    assert names(tmp_path) == ["a.png", "a_edited.png"]
    assert (tmp_path / "a_edited.png").read_bytes() == before


def test_an_edit_of_no_skin_keeps_the_one_before(
    edit: Predict,
    skinless_file: Path,
    photo: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert edit(photo, "--melanin", "2") == 0
    before = (tmp_path / "a_edited.png").read_bytes()
    assert main(["edit", str(photo), "--melanin", "2", "--model", str(skinless_file)]) == 2
    assert f"No pixel of {photo} changes, and nothing is written:" in capsys.readouterr().err
    assert (tmp_path / "a_edited.png").read_bytes() == before


@pytest.mark.parametrize("source", ["", ".", "none.jpg", "a\0b.jpg", "x" * 300 + ".jpg"])
@pytest.mark.parametrize("verb", [READ, EDIT])
def test_odd_paths_are_sentences(
    verb: list[str],
    source: str,
    model_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*verb, source, "--model", str(model_file)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("skinnet: ") and line.endswith(".")
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["predict"], "predict needs input: photographs"),
        (["predit", "a.jpg"], "There is no verb predit. Did you mean predict?"),
        (["paint", "a.jpg"], "There is no verb paint. ("),
        (["predict", "a.jpg", "--jsn"], "predict has no flag --jsn. Did you mean --json?"),
        (["predict", "a.jpg", "--rec"], "predict has no flag --rec. Did you mean --recursive?"),
        (["predict", "a.jpg", "--white_colour"], "Did you mean --white-colour?"),
        (["predict", "a.jpg", "--region", "fce"], "--region is face or skin; got 'fce'. Did you"),
        (["predict", "a.jpg", "-x"], "predict does not know what '-x' is for."),
        (["predict", "a.jpg", "-o"], "-o/--output needs a value"),
        (["predict", "a.jpg", "--json=3"], "--json takes no value; got '3'."),
        (["predict", "a.jpg", "-q", "-v"], "-v/--verbose and -q/--quiet exclude each other"),
        (["edit", "a.jpg", "--melanin", "dark"], "--melanin is a number; got 'dark'."),
        (["web", "--port", "dark"], "--port is a whole number; got 'dark'."),
        (["help", "predit"], "There is no verb predit. Did you mean predict?"),
        (["--jsn", "predict"], "skinnet has no flag --jsn before the verb."),
    ],
)
def test_a_mistake_is_answered_with_a_sentence(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == "" and len(err.splitlines()) == 1
    assert err.startswith(f"skinnet: {said}") or (said.startswith("Did you") and said in err)


@pytest.mark.parametrize("arguments", [[], ["help"], ["--help"], ["-q", "-h"]])
def test_the_command_alone_lists_its_verbs(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert all(f"\n  {verb} " in out for verb in [*cli.PHOTO_VERBS, *cli.PIPELINE_VERBS])


def test_quiet_and_verbose_may_stand_before_the_verb(
    predict: Predict, photo: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["predict", str(photo), str(photo), "--model", str(model_file)]
    assert main(["-q", *arguments]) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 1 and err == ""
    assert main([*arguments, "-v"]) == 0
    assert "predict took" in capsys.readouterr().err


@pytest.mark.parametrize("flags", [[], ["-v"]])
def test_a_fault_is_a_sentence(
    flags: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(options: object) -> bool:
        raise LookupError("nothing there")

    monkeypatch.setattr("skinnet.inference._photo_verbs.predict", fail)
    assert main([*flags, "predict", "a.jpg"]) == 70
    err = capsys.readouterr().err
    assert "An unexpected error, LookupError: nothing there." in err.splitlines()[-1]
    assert ("Traceback" in err) is bool(flags)


def test_an_interrupt_is_quiet(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(options: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("skinnet.inference._photo_verbs.predict", interrupt)
    assert main(["predict", "a.jpg"]) == 130
    assert capsys.readouterr() == ("", "")


def test_the_command_runs_as_a_module() -> None:
    command = [sys.executable, "-W", "error", "-m", "skinnet"]
    shown = subprocess.run([*command, "--version"], check=True, capture_output=True, text=True)
    assert shown.stdout == f"skinnet {__version__}\n"
    failed = subprocess.run(
        [*command, "edit", "none.jpg", "--melanin", "99"], capture_output=True, text=True
    )
    assert failed.returncode == 2 and failed.stdout == ""
    assert failed.stderr.startswith("skinnet: ") and len(failed.stderr.splitlines()) == 1


def test_a_name_that_the_pipe_cannot_take_is_escaped(photo: Path, model_file: Path) -> None:
    odd = photo.rename(photo.with_name("\u00e9\udcff.png"))
    command = [sys.executable, "-m", "skinnet", "predict", odd, "--model", model_file]
    for option in ([], ["--json"]):
        done = subprocess.run(
            [*command, *option],
            env={**os.environ, "PYTHONIOENCODING": "ascii"},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        assert "\\udcff.png" in done.stdout


def test_a_closed_pipe_is_no_traceback(photo: Path, model_file: Path) -> None:
    command = [sys.executable, "-m", "skinnet", "predict", photo, "--model", model_file]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 1


def test_an_empty_name_is_not_the_current_folder(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["predict", ""]) == 2
    assert "empty name" in capsys.readouterr().err


def test_what_runs_the_networks_is_chosen(
    photo: Path, model_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["predict", str(photo), "--json", "--model", str(model_file), "--provider"]
    assert main([*arguments, "cuda, cpu"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["provider"] == "cpu"
    assert "The networks ran on cpu, since the execution provider cuda is missing." in said.err
    assert main([*arguments, "cuda"]) == 2
    assert "pip install onnxruntime-gpu" in capsys.readouterr().err
    assert main([*arguments, "gpu"]) == 2
    assert "There is no execution provider 'gpu'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["photo.png"], "Did you mean skinnet predict photo.png?"),
        (["predict", "https://example.org/a.jpg"], "is an address"),
        (["predict", "photo.png", "-o", "-"], "-o is a folder"),
        (["predict", "--report", "photo.png"], "--report has taken photo.png"),
        (["predict", "-dash.png"], "give files after --"),
        (["edit", "photo.png", "-melanin", "2"], "Did you mean --melanin?"),
        (["edit", "photo.png", "--melanin", "1,5"], "A point stands before decimals."),
    ],
)
def test_a_slip_of_a_newcomer_is_answered(
    words: list[str],
    sentence: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("photo.png", "-dash.png"):
        Path(name).touch()
    assert main(words) == 2
    assert sentence in capsys.readouterr().err


def test_a_folder_of_results_alone_says_so(
    photo: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "tanned"
    assert main(["edit", str(photo), "--melanin", "1.5", "-o", f"{folder}/"]) == 0
    assert main(["edit", str(folder), "--melanin", "1.5"]) == 2
    assert "tanned holds no photographs, only results of skinnet" in capsys.readouterr().err
