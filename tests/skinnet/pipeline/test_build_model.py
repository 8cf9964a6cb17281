"""`skinnet build-model`, `sample` and `edit-maps`."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pipeline_scans import SIZE

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.maps_file import load_maps, save_maps
from skinnet.cli import main

Refused = Callable[..., str]


def test_models_measures_and_pictures_are_there(model: Path) -> None:
    hybrid = HybridModel.load(model / "hybrid.npz")
    linear = LinearModel.load(model / "linear.npz")
    assert len(hybrid.statistics.variances) == len(linear.statistics.variances) == 2
    record = json.loads((model / "measures.json").read_text())
    assert record["subjects"] == 3
    assert set(record["measures"]) == {"HybridModel", "LinearModel"}
    pictures = {file.name for file in model.glob("*.png")}
    assert pictures == {"measures.png", "components_hybrid.png", "components_linear.png"}
    assert not (model / "stack").exists()


def test_a_joint_model_is_built_where_the_shape_model_is_named(maps: Path, tmp_path: Path) -> None:
    from skinnet.shape import load_shape_model
    from skinnet.shape.model_formats import save_shape_model

    save_shape_model(tmp_path / "shape.npz", load_shape_model())
    command = ["build-model", str(maps), "-o", str(tmp_path / "out"), "--model.samples=3"]
    assert main([*command, "--joint=true", "--shape", str(tmp_path / "shape.npz")]) == 0
    record = json.loads((tmp_path / "out" / "measures.json").read_text())
    assert "JointModel" in record["measures"]
    assert (tmp_path / "out" / "joint.npz").is_file()


def test_a_drawn_mask_keeps_texels_out(maps: Path, tmp_path: Path) -> None:
    drawn = np.zeros((SIZE, SIZE), np.uint8)
    drawn[:, : SIZE // 2] = 255
    Image.fromarray(drawn).save(tmp_path / "mask.png")
    command = ["build-model", str(maps), "-o", str(tmp_path), "--model.samples=3"]
    assert main([*command, f"--model.mask={tmp_path / 'mask.png'}"]) == 0
    mask = HybridModel.load(tmp_path / "hybrid.npz").mask
    assert mask[:, : SIZE // 2].any() and not mask[:, SIZE // 2 :].any()


def test_a_mask_of_another_size_is_refused(maps: Path, tmp_path: Path, refused: Refused) -> None:
    Image.new("L", (9, 7)).save(tmp_path / "mask.png")
    said = refused("build-model", maps, "-o", tmp_path, f"--model.mask={tmp_path / 'mask.png'}")
    assert f"is 9 x 7 pixels and the maps are {SIZE} x {SIZE}" in said
    assert not list(tmp_path.glob("*.npz"))


def test_subjects_of_another_size_or_colour_are_refused(
    maps: Path, tmp_path: Path, refused: Refused
) -> None:
    for name in "ab":
        shutil.copy(maps / f"{name}_maps.npz", tmp_path)
    texture, colour = load_maps(maps / "c_maps.npz")
    small = type(texture)(
        *(part[::2, ::2].copy() for part in (texture.f_mel, texture.f_blood, texture.offset)),
        texture.mask[::2, ::2].copy(),
    )
    save_maps(tmp_path / "c_maps.npz", small, colour)
    said = refused("build-model", tmp_path, "-o", tmp_path / "out")
    assert f"c_maps.npz has {SIZE // 2} texels a side" in said
    other = type(colour)(calibration=2 * np.eye(3))
    save_maps(tmp_path / "c_maps.npz", texture, other)
    said = refused("build-model", tmp_path, "-o", tmp_path / "out2")
    assert "c_maps.npz was inverted under another light, camera or calibration" in said


def test_too_few_subjects_are_refused(maps: Path, tmp_path: Path, refused: Refused) -> None:
    assert "holds no *_maps.npz" in refused("build-model", tmp_path)
    assert "There is no" in refused("build-model", tmp_path / "absent")
    said = refused("build-model", maps / "a_maps.npz", "-o", tmp_path)
    assert "1 subjects were found" in said
    said = refused("build-model", maps, "-o", tmp_path, "--model.components=9")
    assert "9" in said and "components" in said


def test_an_interrupted_build_goes_on(
    maps: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from skinnet.pipeline import _model_inputs

    command = ["build-model", str(maps), "-o", str(tmp_path), "--model.samples=3"]
    whole = _model_inputs._read_texture

    def broken(file: Path) -> object:
        if file.name.startswith("c"):
            raise KeyboardInterrupt
        return whole(file)

    monkeypatch.setattr(_model_inputs, "_read_texture", broken)
    assert main(command) == 130
    monkeypatch.undo()
    capsys.readouterr()
    assert main(command) == 0
    said = capsys.readouterr().err
    assert "c_maps.npz is read" in said and "a_maps.npz is read" not in said


def test_samples_are_skins_and_the_same_twice(model: Path, tmp_path: Path) -> None:
    command = ["sample", str(model / "hybrid.npz"), "-n", "3", "--seed", "5", "-o"]
    for folder in ("one", "two"):
        assert main([*command, str(tmp_path / folder)]) == 0
    for number in range(3):
        pair = [
            load_maps(tmp_path / folder / f"sample_{number:02}_maps.npz")[0]
            for folder in ("one", "two")
        ]
        np.testing.assert_array_equal(pair[0].f_mel, pair[1].f_mel)
        assert pair[0].f_mel[pair[0].mask].min() >= 0
    assert (tmp_path / "one" / "samples.png").is_file()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["-n", "0"], "count is 1 or more"),
        (["--spread=-1"], "spread is a number of deviations"),
    ],
)
def test_bad_samples_are_refused(
    model: Path, refused: Refused, options: list[str], words: str
) -> None:
    assert words in refused("sample", model / "hybrid.npz", *options)


def test_a_linear_model_is_no_hybrid(model: Path, refused: Refused) -> None:
    said = refused("sample", model / "linear.npz")
    assert "is a LinearModel, and a HybridModel is wanted" in said


def test_maps_are_scaled_added_to_and_painted(maps: Path, tmp_path: Path) -> None:
    before, _ = load_maps(maps / "a_maps.npz")
    mask = np.zeros((SIZE, SIZE), np.uint8)
    mask[: SIZE // 2] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    command = ["edit-maps", str(maps / "a_maps.npz"), "-o", str(tmp_path)]
    options = ["--melanin=1.5", "--hemoglobin_add=0.01", f"--mask={tmp_path / 'mask.png'}"]
    assert main([*command, *options, "--relight.size=64"]) == 0
    after, _ = load_maps(tmp_path / "a_edited_maps.npz")
    top = before.mask & (mask > 0)
    np.testing.assert_allclose(after.f_mel[top], 1.5 * before.f_mel[top], rtol=1e-5)
    np.testing.assert_allclose(after.f_blood[top], before.f_blood[top] + 0.01, rtol=1e-4)
    low = before.mask & (mask == 0)
    np.testing.assert_array_equal(after.f_mel[low], before.f_mel[low])
    np.testing.assert_array_equal(after.offset, before.offset)
    files = {file.name for file in tmp_path.iterdir()}
    assert {"a_edited_render.png", "a_edited_panel.png", "a_edited_albedo.png"} <= files
    assert main([*command, "--melanin_paint=0.2", "--relight.size=64"]) == 0
    painted, _ = load_maps(tmp_path / "a_edited_maps.npz")
    np.testing.assert_allclose(painted.f_mel[before.mask], 0.2, rtol=1e-6)


def test_maps_without_a_mesh_are_edited_all_the_same(
    maps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(maps / "a_maps.npz", tmp_path)
    assert main(["edit-maps", str(tmp_path / "a_maps.npz"), "--hemoglobin=2"]) == 0
    assert "the albedo alone is written" in capsys.readouterr().err
    assert (tmp_path / "a_edited_albedo.png").is_file()


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("--melanin=-1", "scale is a factor from 0 to 10"),
        ("--melanin_add=20", "Was it given in percent?"),
        ("--hemoglobin_paint=5", "Was it given in percent?"),
        ("--mask=absent.png", "absent.png"),
        ("--relight.strengths=[1,2]", "1 lamps and 2 strengths"),
        ("--relight.harmonics=[1,2]", "nine coefficients"),
        ("--relight.size=1", "size is a number of pixels"),
    ],
)
def test_a_bad_edit_is_refused(
    maps: Path, tmp_path: Path, refused: Refused, option: str, words: str
) -> None:
    said = refused("edit-maps", maps / "a_maps.npz", "-o", tmp_path, option)
    assert words in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("old", "new"), [("turn", "yaw"), ("tilt", "pitch")])
def test_old_names_of_the_camera_angles_are_answered_with_the_new(
    maps: Path, tmp_path: Path, refused: Refused, old: str, new: str
) -> None:
    command = ("edit-maps", maps / "a_maps.npz", "-o", tmp_path)
    sentence = f"'relight.{old}' is now called 'relight.{new}'; use the new name."
    assert sentence in refused(*command, f"--relight.{old}=20")
    assert sentence in refused(*command, f"--relight.{old}", 20)
    (tmp_path / "old.yaml").write_text(f"relight:\n  {old}: 20.0\n")
    assert f"'{old}' is now called '{new}'; use the new name." in refused(
        *command, "--config", tmp_path / "old.yaml"
    )
    (tmp_path / "dotted.yaml").write_text(f"relight.{old}: 20.0\n")
    assert f"{new}'; use the new name." in refused(*command, "--config", tmp_path / "dotted.yaml")


def test_something_else_than_maps_is_refused(model: Path, tmp_path: Path, refused: Refused) -> None:
    assert "There is no file" in refused("edit-maps", tmp_path / "absent_maps.npz")
    said = refused("edit-maps", model / "hybrid.npz")
    assert "is a HybridModel, and a SkinTexture is wanted" in said
