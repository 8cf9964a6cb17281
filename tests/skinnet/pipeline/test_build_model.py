"""`skinnet build-model`."""

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

pytestmark = pytest.mark.slow

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
    command = ["build-model", str(maps), "-o", str(tmp_path / "out"), "--appearance.samples=3"]
    assert main([*command, "--joint=true", "--shape", str(tmp_path / "shape.npz")]) == 0
    record = json.loads((tmp_path / "out" / "measures.json").read_text())
    assert "JointModel" in record["measures"]
    assert (tmp_path / "out" / "joint.npz").is_file()


def test_a_drawn_mask_keeps_texels_out(maps: Path, tmp_path: Path) -> None:
    drawn = np.zeros((SIZE, SIZE), np.uint8)
    drawn[:, : SIZE // 2] = 255
    Image.fromarray(drawn).save(tmp_path / "mask.png")
    command = ["build-model", str(maps), "-o", str(tmp_path), "--appearance.samples=3"]
    assert main([*command, f"--appearance.mask={tmp_path / 'mask.png'}"]) == 0
    mask = HybridModel.load(tmp_path / "hybrid.npz").mask
    assert mask[:, : SIZE // 2].any() and not mask[:, SIZE // 2 :].any()


def test_a_mask_of_another_size_is_refused(maps: Path, tmp_path: Path, refused: Refused) -> None:
    Image.new("L", (9, 7)).save(tmp_path / "mask.png")
    said = refused(
        "build-model", maps, "-o", tmp_path, f"--appearance.mask={tmp_path / 'mask.png'}"
    )
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
    said = refused("build-model", maps, "-o", tmp_path, "--appearance.components=9")
    assert "9" in said and "components" in said


def test_an_interrupted_build_goes_on(
    maps: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from skinnet.pipeline import _model_inputs

    command = ["build-model", str(maps), "-o", str(tmp_path), "--appearance.samples=3"]
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
