"""`skinnet edit-maps`."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pipeline_scans import SIZE

from skinnet.appearance.maps_file import load_maps
from skinnet.cli import main

pytestmark = pytest.mark.slow

Refused = Callable[..., str]


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
    np.testing.assert_array_equal(after.offset[low], before.offset[low])
    assert (np.abs(after.offset[top]) <= np.abs(before.offset[top])).all()
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
        ("--melanin=2 --mask=absent.png", "absent.png"),
        ("--relight.strengths=[1,2]", "1 lamps and 2 strengths"),
        ("--relight.harmonics=[1,2]", "nine coefficients"),
        ("--relight.size=1", "size is a number of pixels"),
    ],
)
def test_a_bad_edit_is_refused(
    maps: Path, tmp_path: Path, refused: Refused, option: str, words: str
) -> None:
    said = refused("edit-maps", maps / "a_maps.npz", "-o", tmp_path, *option.split())
    assert words in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("old", "new"), [("turn", "yaw"), ("tilt", "pitch")])
def test_old_names_of_the_camera_angles_are_answered_with_the_new(
    maps: Path, tmp_path: Path, refused: Refused, old: str, new: str
) -> None:
    command = ("edit-maps", maps / "a_maps.npz", "-o", tmp_path)
    sentence = f"--relight.{old} of skinnet edit-maps is now called --relight.{new}; use that name."
    assert sentence in refused(*command, f"--relight.{old}=20")
    assert sentence in refused(*command, f"--relight.{old}", 20)
    (tmp_path / "old.yaml").write_text(f"relight:\n  {old}: 20.0\n")
    assert f"'{old}' is now called '{new}'; use the new name." in refused(
        *command, "--config", tmp_path / "old.yaml"
    )
    (tmp_path / "dotted.yaml").write_text(f"relight.{old}: 20.0\n")
    assert f"{new}'; use the new name." in refused(*command, "--config", tmp_path / "dotted.yaml")


def test_no_edit_is_refused(maps: Path, tmp_path: Path, refused: Refused) -> None:
    command = ("edit-maps", maps / "a_maps.npz", "-o", tmp_path)
    for options in ((), ("--melanin=1.0",), ("--hemoglobin_add=0",)):
        assert "Nothing is edited: all factors are 1" in refused(*command, *options)
    assert not list(tmp_path.iterdir())


def test_something_else_than_maps_is_refused(model: Path, tmp_path: Path, refused: Refused) -> None:
    assert "There is no file" in refused("edit-maps", tmp_path / "absent_maps.npz")
    said = refused("edit-maps", model / "hybrid.npz")
    assert "is a HybridModel, and a SkinTexture is needed" in said
