"""Nothing that another input, or the user, has in an output folder is replaced in silence."""

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pipeline_scans import pigments, write_scan

from skinnet.appearance.maps_file import load_maps, save_maps
from skinnet.cli import main
from skinnet.images._mark import read_mark
from skinnet.pipeline import _fit_shape, _maps_writer, _model_results
from skinnet.pipeline._source import read_result_mark

FAST = ("--fit.stages", "[[500, 5, 100.0]]")
WARP = "--warp.size=32"
Contents = dict[str, bytes]


@pytest.fixture(scope="module", autouse=True)
def blank_pictures() -> Iterator[None]:
    """Leaves pictures blank: rendering would take most of the time of these tests."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name in (
            (_fit_shape, "draw_fit"),
            (_maps_writer, "draw_maps_panel"),
            (_model_results, "draw_hybrid"),
            (_model_results, "draw_linear"),
        ):
            patch.setattr(module, name, lambda *_, **__: np.zeros((8, 8, 3), np.uint8))
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two people whose scans are called a.obj, in one and two, and the maps of both in out."""
    folder = tmp_path_factory.mktemp("made")
    for seed, name in ((1, "one"), (2, "two")):
        (folder / name).mkdir()
        write_scan(folder / name / "a.obj", seed)
        assert main(make_maps(folder, name, folder / "out")) == 0
    return folder


@pytest.fixture
def people(made: Path, tmp_path: Path) -> Path:
    """A copy of these folders that a test may change."""
    shutil.copytree(made, tmp_path / "people")
    return tmp_path / "people"


def make_maps(folder: Path, name: str, output: Path) -> list[str]:
    return ["maps", str(folder / name / "a.obj"), *FAST, WARP, "-o", str(output)]


def read_all(folder: Path) -> Contents:
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def test_two_people_of_one_name_have_their_own_maps(made: Path) -> None:
    for seed, name in ((1, "a"), (2, "a-2")):
        texture, _ = load_maps(made / "out" / f"{name}_maps.npz")
        f_mel, f_blood = (one.mean().item() for one in pigments(seed))
        assert np.median(texture.f_mel[texture.mask]) == pytest.approx(f_mel, rel=0.15)
        assert np.median(texture.f_blood[texture.mask]) == pytest.approx(f_blood, rel=0.15)
        record = json.loads((made / "out" / f"{name}_maps.json").read_text())
        assert record["input"]["path"] == f"../{'one' if seed == 1 else 'two'}/a.obj"


@pytest.mark.parametrize("name", ["one", "two"])
@pytest.mark.parametrize("verb", ["maps", "fit-shape"])
def test_a_second_run_of_one_input_keeps_its_own(people: Path, name: str, verb: str) -> None:
    before = read_all(people / "out")
    command = [verb, *make_maps(people, name, people / "out")[1:]]
    assert main([word for word in command if verb == "maps" or word != WARP]) == 0
    assert read_all(people / "out") == before


def test_another_setting_replaces_only_the_own_results(people: Path) -> None:
    before = read_all(people / "out")
    assert main([*make_maps(people, "two", people / "out"), "--colour.light=A"]) == 0
    after = read_all(people / "out")
    assert after.keys() == before.keys()
    changed = {name for name, content in after.items() if content != before[name]}
    assert {"a-2_maps.npz", "a-2_maps.json"} <= changed
    assert all(name.startswith("a-2_") for name in changed)


@pytest.mark.parametrize("name", ["a_panel.png", "A_Maps.JSON", "a_face.obj"])
def test_a_file_of_the_user_is_left_alone(people: Path, name: str) -> None:
    output = people / "new"
    output.mkdir()
    Image.new("RGB", (4, 4)).save(output / name, "PNG")
    before = (output / name).read_bytes()
    command = make_maps(people, "one", output)
    assert main(["fit-shape", *(word for word in command[1:] if word != WARP)]) == 0
    assert (output / name).read_bytes() == before
    assert (output / "a-2_shape.npz").is_file()
    assert {file.name for file in output.glob("[aA]_*")} == {name}


def test_a_result_that_the_user_has_painted_is_left_alone(people: Path) -> None:
    painted = people / "out" / "a_face.png"
    Image.new("RGB", (32, 32), "red").save(painted)
    before = read_all(people / "out")
    assert main([*make_maps(people, "one", people / "out"), "--colour.light=A"]) == 0
    after = read_all(people / "out")
    assert {name: after[name] for name in before} == before
    assert (people / "out" / "a-3_maps.npz").is_file()


def test_an_interrupted_run_is_continued_under_its_name(people: Path) -> None:
    for name in ("a_shape.json", "a_maps.json", "a_warp.npz"):
        (people / "out" / name).unlink()
    assert main(make_maps(people, "one", people / "out")) == 0
    assert not (people / "out" / "a-3_shape.npz").exists()
    assert (people / "out" / "a_maps.json").is_file()


def test_a_name_that_is_taken_during_the_fit_is_left_alone(
    people: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    register = _fit_shape.register

    def take(*arguments: object) -> object:
        (people / "new" / "a_shape.json").write_text("another process wrote this")
        return register(*arguments)

    monkeypatch.setattr(_fit_shape, "register", take)
    command = make_maps(people, "one", people / "new")
    assert main(["fit-shape", *(word for word in command[1:] if word != WARP)]) == 0
    assert (people / "new" / "a_shape.json").read_text() == "another process wrote this"
    assert (people / "new" / "a-2_shape.npz").is_file()


def test_a_changed_scan_is_another_input(people: Path) -> None:
    before = read_all(people / "out")
    write_scan(people / "one" / "a.obj", 3)
    command = make_maps(people, "one", people / "out")
    assert main(["fit-shape", *(word for word in command[1:] if word != WARP)]) == 0
    after = read_all(people / "out")
    assert {name: after[name] for name in before} == before
    assert (people / "out" / "a-3_shape.npz").is_file()


def test_results_of_an_earlier_version_stay_with_their_scan(people: Path) -> None:
    for file in (people / "out").glob("a_*.json"):
        record = json.loads(file.read_text())
        del record["input"], record["mark"]
        file.write_text(json.dumps(record | {"file": str(people / "one" / "a.obj")}))
    image = Image.open(people / "out" / "a_panel.png").copy()
    image.save(people / "out" / "a_panel.png")
    before = read_all(people / "out")
    assert main(make_maps(people, "one", people / "out")) == 0
    assert read_all(people / "out").keys() == before.keys()


@pytest.mark.parametrize(
    "end", ["shape.npz", "shape.obj", "shape.png", "shape.json", "warp.npz", "warp.json",
            "maps.npz", "maps.json", "melanin.png", "hemoglobin.png", "panel.png", "face.obj",
            "face.mtl", "face.png"],
)  # fmt: skip
def test_every_result_carries_a_mark(made: Path, end: str) -> None:
    marks = [read_result_mark(made / "out" / f"{name}_{end}") for name in ("a", "a-2")]
    assert all(mark is not None and mark.version for mark in marks)
    assert len({mark.digest for mark in marks if mark}) == 2
    if end.endswith(".png"):
        assert read_mark(made / "out" / f"a_{end}") == marks[0]


@pytest.mark.parametrize("name", ["a_face.obj", "a_shape.obj", "a-2_face.obj"])
@pytest.mark.parametrize("verb", ["fit-shape", "maps"])
def test_a_result_is_no_scan(
    people: Path, refused: Callable[..., str], name: str, verb: str
) -> None:
    said = refused(verb, people / "out" / name)
    assert f"{name} is a result of skinnet" in said and "not a scan; give the scan" in said
    assert not (people / "out" / "skinmaps").exists()


@pytest.mark.parametrize("name", ["a_face.obj", "a_shape.obj"])
def test_a_result_of_an_earlier_version_is_no_scan(
    people: Path, refused: Callable[..., str], name: str
) -> None:
    path = people / "out" / name
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(line for line in lines if not line.startswith("#")))
    assert "not a scan" in refused("fit-shape", path)


def test_a_pattern_that_no_shell_has_expanded_is_expanded(
    people: Path, refused: Callable[..., str]
) -> None:
    said = refused("fit-shape", people / "out" / "*.obj")
    assert said.count("is a result of skinnet") == 4
    assert "No file matches" in refused("fit-shape", people / "out" / "*.ply")


def test_edits_of_two_people_of_one_name_are_apart(people: Path) -> None:
    output = people / "edits"
    for name, melanin in (("a", 1.5), ("a-2", 2.0), ("a", 3.0)):
        (people / name).mkdir(exist_ok=True)
        shutil.copy(people / "out" / f"{name}_maps.npz", people / name / "a_maps.npz")
        command = ["edit-maps", str(people / name / "a_maps.npz"), "-o", str(output)]
        assert main([*command, f"--melanin={melanin}"]) == 0
    assert {file.name for file in output.glob("*.npz")} == {
        "a_edited_maps.npz",
        "a_edited-2_maps.npz",
    }
    for name, edited, factor in (("a", "a_edited", 3.0), ("a-2", "a_edited-2", 2.0)):
        before, after = (
            load_maps(path)[0]
            for path in (people / name / "a_maps.npz", output / f"{edited}_maps.npz")
        )
        np.testing.assert_allclose(
            after.f_mel[before.mask], factor * before.f_mel[before.mask], rtol=1e-5
        )
    assert read_mark(output / "a_edited_albedo.png") is not None


def write_subjects(people: Path, folder: str, factor: float) -> Path:
    """Maps of three people, from those of the two."""
    (people / folder).mkdir()
    for number, name in enumerate(("a", "a-2", "a")):
        texture, colour = load_maps(people / "out" / f"{name}_maps.npz")
        scaled = type(texture)(
            texture.f_mel * np.float32(factor + 0.1 * number),
            texture.f_blood,
            texture.offset,
            texture.mask,
        )
        save_maps(people / folder / f"{number}_maps.npz", scaled, colour)
    return people / folder


@pytest.fixture(scope="module")
def models(made: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two sets of subjects, the model of the first, and samples from it."""
    folder = tmp_path_factory.mktemp("models")
    shutil.copytree(made / "out", folder / "out")
    for name, factor in (("first", 1.0), ("second", 0.5)):
        write_subjects(folder, name, factor)
    assert main(build(folder, "first", "model")) == 0
    assert main(sample(folder / "model", folder / "samples")) == 0
    return folder


def build(folder: Path, subjects: str, model: str) -> list[str]:
    words = ["build-model", str(folder / subjects), "-o", str(folder / model)]
    return [*words, "--appearance.samples=2"]


def sample(model: Path, output: Path) -> list[str]:
    return ["sample", str(model / "hybrid.npz"), "-n", "1", "-o", str(output)]


def test_a_model_of_other_people_is_not_replaced(models: Path, refused: Callable[..., str]) -> None:
    before = read_all(models / "model")
    said = refused(*build(models, "second", "model"))
    assert "hybrid.npz is there already and was not made from these 3 files" in said
    assert read_all(models / "model") == before
    assert main([*build(models, "first", "model"), "--appearance.components=1"]) == 0
    assert read_all(models / "model")["hybrid.npz"] != before["hybrid.npz"]


def test_models_and_samples_carry_a_mark(models: Path) -> None:
    for folder, verb in (("model", "build-model"), ("samples", "sample")):
        files = sorted((models / folder).iterdir())
        marks = [read_result_mark(file) for file in files]
        assert len(files) == (6 if folder == "model" else 3)
        assert {mark.verb for mark in marks if mark} == {verb} and None not in marks
        assert all(read_mark(file) for file in files if file.suffix == ".png")


def test_the_default_folder_of_a_model_gets_a_number(
    models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for subjects in ("first", "second"):
        assert main(["build-model", str(models / subjects), "--appearance.samples=2"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"skinmodel", "skinmodel-2"}


def test_samples_of_another_model_are_not_replaced(
    models: Path, refused: Callable[..., str]
) -> None:
    assert main(build(models, "second", "other")) == 0
    before = read_all(models / "samples")
    said = refused(*sample(models / "other", models / "samples"))
    assert "sample_00_maps.npz is there already and was not made from" in said
    assert read_all(models / "samples") == before
    assert main([*sample(models / "model", models / "samples"), "--seed=3"]) == 0
    assert read_all(models / "samples")["sample_00_maps.npz"] != before["sample_00_maps.npz"]


@pytest.mark.parametrize("name", ["hybrid.npz", "measures.png", "components_linear.png"])
def test_a_file_of_the_user_in_the_folder_of_a_model_is_left_alone(
    models: Path, tmp_path: Path, refused: Callable[..., str], name: str
) -> None:
    (tmp_path / name).write_bytes(b"mine")
    command = ["build-model", models / "first", "-o", tmp_path, "--appearance.samples=2"]
    assert f"{name} is there already" in refused(*command)
    assert read_all(tmp_path) == {name: b"mine"}


def test_a_folder_of_the_user_called_stack_is_left_alone(
    models: Path, tmp_path: Path, refused: Callable[..., str]
) -> None:
    (tmp_path / "stack").mkdir()
    (tmp_path / "stack" / "focus.tif").write_bytes(b"mine")
    command = ["build-model", models / "first", "-o", tmp_path, "--appearance.samples=2"]
    assert "stack holds other files (focus.tif)" in refused(*command)
    assert (tmp_path / "stack" / "focus.tif").read_bytes() == b"mine"


def test_random_and_edited_faces_are_no_subjects(
    models: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file in (models / "first").iterdir():
        shutil.copy(file, tmp_path)
    shutil.copy(models / "samples" / "sample_00_maps.npz", tmp_path)
    assert main(["edit-maps", str(tmp_path / "1_maps.npz"), "--melanin=1.5"]) == 0
    (tmp_path / "1_edited_maps.npz").rename(tmp_path / "darker_maps.npz")
    command = [
        "build-model",
        str(tmp_path),
        "-o",
        str(tmp_path / "model"),
        "--appearance.samples=2",
    ]
    assert main(command) == 0
    said = capsys.readouterr()
    assert "sample_00_maps.npz is a random face and is left out" in said.err
    assert "darker_maps.npz is an edited face and is left out" in said.err
    assert "3 subjects" in said.out
