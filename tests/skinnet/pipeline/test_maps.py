"""`skinnet maps`, on scans whose pigments are known."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pipeline_scans import FAST, SIZE, pigments

from skinnet.appearance.maps_file import load_maps
from skinnet.cli import main
from skinnet.mesh.mesh_file import read_mesh

pytestmark = pytest.mark.slow

Refused = Callable[..., str]


def test_the_pigments_of_a_scan_come_back(maps: Path) -> None:
    for seed, name in enumerate("abc", 1):
        texture, _ = load_maps(maps / f"{name}_maps.npz")
        assert texture.mask.mean() > 0.5
        f_mel, f_blood = (one.mean().item() for one in pigments(seed))
        assert np.median(texture.f_mel[texture.mask]) == pytest.approx(f_mel, rel=0.15)
        assert np.median(texture.f_blood[texture.mask]) == pytest.approx(f_blood, rel=0.15)
        assert np.abs(texture.offset[texture.mask]).mean() < 0.01


def test_the_records_and_pictures_are_there(maps: Path) -> None:
    record = json.loads((maps / "a_maps.json").read_text())
    assert record["exposure"] == pytest.approx(1, abs=0.1)
    assert record["off_manifold"] < 0.1
    assert record["settings"]["light"] == "D65"
    with Image.open(maps / "a_melanin.png") as melanin:
        scale = float(melanin.text["scale"])
        values = scale * np.asarray(melanin)
    texture, _ = load_maps(maps / "a_maps.npz")
    known = texture.mask
    np.testing.assert_allclose(values[known], texture.f_mel[known], atol=scale)
    assert read_mesh(maps / "a_face.obj").texture.shape == (SIZE, SIZE, 3)
    assert (maps / "a_panel.png").stat().st_size > 20_000


def test_finished_work_is_kept_and_lost_work_is_made_again(
    scans: Path, maps: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["maps", *(str(scans / f"{name}.obj") for name in "abc"), *FAST]
    command.append(f"--warp.size={SIZE}")
    before = {file.name: file.stat().st_mtime_ns for file in maps.iterdir()}
    (maps / "b_maps.npz").unlink()
    capsys.readouterr()
    assert main(command) == 0
    said = capsys.readouterr()
    assert "a_maps.npz is there already and is kept" in said.err
    assert "b_maps.npz is there already" not in said.err
    assert [line.partition(": median")[0][-5:] for line in said.out.splitlines()] == [
        *("a.obj", "b.obj", "c.obj")
    ]
    after = {file.name: file.stat().st_mtime_ns for file in maps.iterdir()}
    assert before.keys() == after.keys()
    assert after["b_shape.npz"] == before["b_shape.npz"]


def test_a_calibration_file_is_used(scans: Path, tmp_path: Path) -> None:
    transform = {"transform": (1.5 * np.eye(3)).tolist()}
    (tmp_path / "calibration.json").write_text(json.dumps(transform))
    command = ["maps", str(scans / "a.obj"), *FAST, f"--warp.size={SIZE}", "-o", str(tmp_path)]
    assert main([*command, f"--colour.calibration={tmp_path / 'calibration.json'}"]) == 0
    texture, colour = load_maps(tmp_path / "a_maps.npz")
    np.testing.assert_allclose(colour.calibration, 1.5 * np.eye(3))
    # A brighter scale makes the same texture darker skin.
    assert np.median(texture.f_mel[texture.mask]) > 1.2 * pigments(1)[0].mean().item()


def test_a_scan_without_texture_is_refused(scans: Path, tmp_path: Path, refused: Refused) -> None:
    lines = (scans / "a.obj").read_text().splitlines()
    plain = [line for line in lines if not line.startswith(("vt", "mtllib", "usemtl"))]
    faces = [" ".join(part.split("/")[0] for part in line.split()) for line in plain]
    (tmp_path / "a.obj").write_text("\n".join(faces))
    assert "texture coordinates" in refused("maps", tmp_path / "a.obj", *FAST)
    assert not (tmp_path / "skinmaps").exists()


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("--colour.light=moon", "no light 'moon'"),
        ("--colour.camera=Nikkon", "no camera 'Nikkon'"),
        ("--colour.calibration=half", "calibration is exposure, common, full, none"),
        ("--colour.white=[0,1,2]", "white is three numbers"),
        ("--warp.size=4", "size is a number of texels"),
    ],
)
def test_a_bad_setting_is_named(
    scans: Path, maps: Path, refused: Refused, option: str, words: str
) -> None:
    said = refused("maps", scans / "a.obj", *FAST, f"--warp.size={SIZE}", option)
    assert words in said


def test_a_model_without_texture_space_gets_one(
    scans: Path, tmp_path: Path, refused: Refused
) -> None:
    shutil.copy(scans / "a.obj", tmp_path / "x.obj")
    said = refused("maps", tmp_path / "x.obj", "--warp.own_uv=true", "--shape=absent")
    assert "There is no shape model absent" in said
