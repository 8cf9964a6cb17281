"""`skinnet export-face`: what another reader, and Blender, find in the files."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pipeline_scans import SIZE

from skinnet.appearance.maps_file import load_maps
from skinnet.cli import main
from skinnet.images.srgb import linear_to_srgb, to_uint8

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
BLENDER = ROOT / ".venv-blender/bin/python"


@pytest.fixture(scope="module")
def heads(maps: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a_head.glb and a_head.usdz."""
    folder = tmp_path_factory.mktemp("heads")
    for kind in ("glb", "usdz"):
        command = ["export-face", str(maps / "a_maps.npz"), "-o", str(folder)]
        assert main([*command, f"--format={kind}"]) == 0
    return folder


def read_json(path: Path) -> dict:
    data = path.read_bytes()
    return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def test_trimesh_reads_the_glb_in_metres_with_its_colours(heads: Path, maps: Path) -> None:
    scene = trimesh.load(heads / "a_head.glb")
    mesh = next(iter(scene.geometry.values()))
    width, height, depth = scene.extents
    assert 0.15 < height < 0.25 and height > width > depth
    # The nose is foremost, along z, near the middle.
    nose = mesh.vertices[mesh.vertices[:, 2].argmax()]
    assert abs(nose[0]) < 0.01
    texture, colour = load_maps(maps / "a_maps.npz")
    expected = to_uint8(linear_to_srgb(texture.albedo(colour)))[texture.mask]
    found = np.asarray(mesh.visual.material.baseColorTexture.convert("RGB"))[texture.mask]
    assert np.array_equal(found, expected)
    normals = np.asarray(mesh.visual.material.normalTexture).astype(float) / 127.5 - 1
    assert np.linalg.norm(normals, axis=-1) == pytest.approx(1, abs=0.02)
    assert normals[..., 2].mean() > 0.98  # the scan is the face, nearly


def test_the_pigments_are_textures_that_extras_name(heads: Path, maps: Path) -> None:
    document = read_json(heads / "a_head.glb")
    entry = document["materials"][0]["extras"]["skinnet"]
    texture, _ = load_maps(maps / "a_maps.npz")
    for name, values in (("melanin", texture.f_mel), ("hemoglobin", texture.f_blood)):
        image = document["images"][document["textures"][entry[name]["texture"]["index"]]["source"]]
        assert image["name"] == name
        assert entry[name]["scale"] == pytest.approx(values[texture.mask].max(), rel=0.2)
    assert entry["light"] == "D65" and entry["optics"] == "measured"
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    assert {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"} <= {*attributes}


def test_usd_reads_the_usdz_with_its_units(heads: Path) -> None:
    from pxr import Usd, UsdGeom, UsdShade

    stage = Usd.Stage.Open(str(heads / "a_head.usdz"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    points = np.array(UsdGeom.Mesh.Get(stage, "/head/mesh").GetPointsAttr().Get())
    assert 0.15 < np.ptp(points[:, 1]) < 0.25
    for name in ("albedo", "normal", "melanin", "hemoglobin"):
        shader = UsdShade.Shader.Get(stage, f"/head/skin/{name}")
        assert shader.GetInput("file").Get().resolvedPath


@pytest.mark.parametrize("kind", ["glb", "usdz"])
def test_blender_opens_it_upright_in_metres_with_its_textures(heads: Path, kind: str) -> None:
    if not BLENDER.is_file():
        pytest.skip("Blender is not installed in .venv-blender: make blender")
    script = ROOT / "tests/open_in_blender.py"
    command = [str(BLENDER), str(script), str(heads / f"a_head.{kind}")]
    done = subprocess.run(command, capture_output=True, text=True)
    line = next(each for each in done.stdout.splitlines() if each.startswith("FOUND "))
    found = json.loads(line.removeprefix("FOUND "))
    width, depth, height = np.subtract(found["high"], found["low"])
    assert 0.15 < height < 0.25 and height > width > depth
    assert abs(found["foremost"][0]) < 0.01  # it looks along -y, at Blender's front view
    assert ["albedo", "BSDF_PRINCIPLED", "Base Color"] in found["links"]
    assert ["normal", "NORMAL_MAP", "Color"] in found["links"]
    assert found["images"]["albedo"] == ["sRGB", SIZE, SIZE]
    assert found["images"]["normal"] == ["Non-Color", SIZE, SIZE]
    if kind == "glb":
        assert {"melanin", "hemoglobin"} <= {*found["images"]}
        assert found["extras"]["melanin"]["unit"] == "volume fraction"


def test_a_head_replaces_its_own_and_no_other_file(
    maps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "a_head.glb"
    own.write_bytes(b"a file of mine")
    command = ["export-face", str(maps / "a_maps.npz"), "-o", str(tmp_path)]
    assert main(command) == main(command) == 0
    assert own.read_bytes() == b"a file of mine"
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a-2_head.glb", "a_head.glb"]
    capsys.readouterr()
    assert main(["maps", str(tmp_path / "a-2_head.glb")]) == 2
    assert "is a result of skinnet export-face, not a scan" in capsys.readouterr().err


def test_what_cannot_be_exported_is_refused(
    maps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch
) -> None:
    def refuse(*arguments: str) -> str:
        assert main(["export-face", str(tmp_path / "a_maps.npz"), *arguments]) == 2
        return capsys.readouterr().err

    shutil.copy(maps / "a_maps.npz", tmp_path)
    assert "a_face.obj that the maps of" in refuse()
    shutil.copy(maps / "a_face.obj", tmp_path)
    assert "give --millimetres" in refuse()
    assert "above 0; got -1" in refuse("--millimetres=-1")
    assert "m high, which no face is" in refuse("--millimetres=1000")
    monkeypatch.setitem(sys.modules, "pxr", None)
    assert 'pip install "skinnet[usd]"' in refuse("--format=usdz")
    lines = (tmp_path / "a_face.obj").read_text().splitlines()
    bare = [each for each in lines if each.startswith("v ")] + ["f 1 2 3"]
    (tmp_path / "a_face.obj").write_text("\n".join(bare))
    assert "has no texture coordinates" in refuse("--millimetres=1")
    assert not list(tmp_path.glob("*head*"))
