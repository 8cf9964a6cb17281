import json
import math
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from benchmarks.shaders import BLENDER, read_table
from skinnet.cli import main
from skinnet.images._png_file import write_png
from skinnet.physics import SkinReflectance, SpectralCamera, load_camera


def write_map(path: Path, name: str, scale: str = "1e-6") -> Path:
    text = {"map": name, "scale": scale, "offset": "0.0"}
    write_png(path, np.full((4, 4), 50000, np.uint16), text)
    return path


def refuse(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    assert main(["shader", *map(str, words)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder: Path = tmp_path_factory.mktemp("shader") / "skin"
    assert main(["shader", "-q", "-o", str(folder)]) == 0
    return folder


def test_the_table_holds_the_colours_of_the_layer_at_its_documented_axes(folder: Path) -> None:
    with Image.open(folder / "skin_table.png") as picture:
        axes = picture.info["melanin"], picture.info["hemoglobin"]
        assert picture.size == (256, 128)
    colours = read_table(folder)[::-1]
    i, j = 200, 77
    formulas = (axis.partition("f = ")[2].replace("^", "**") for axis in axes)
    f_mel, f_blood = (eval(formula, {"i": i, "j": j}) for formula in formulas)
    assert 0 < f_mel < 1 and 0 < f_blood < 1
    camera = SpectralCamera(mean=load_camera("observer"))
    expected = camera(SkinReflectance()(torch.tensor(f_mel), f_blood))
    np.testing.assert_allclose(colours[j, i], expected, atol=2e-5)


def test_both_files_of_the_table_agree(folder: Path) -> None:
    import imagecodecs

    pixels = imagecodecs.png_decode((folder / "skin_table.png").read_bytes())
    assert pixels.dtype == np.uint16
    exact = read_table(folder).clip(0, 1)
    np.testing.assert_allclose(pixels / 65535, exact, atol=1e-5)


def test_json_lists_files_that_are_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--target", "osl", "--target", "glsl", "--size", "32x16", "--light", "LED-B3"]
    assert main(["shader", "--json", "-o", str(tmp_path / "a"), *words]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {Path(each).name for each in found["files"]} == {
        "skin_table.exr",
        "skin_table.png",
        "skin.glsl",
        "skin.osl",
    }
    assert {*map(str, (tmp_path / "a").iterdir())} == {*found["files"]}
    assert (found["table"]["columns"], found["table"]["rows"]) == (32, 16)
    assert found["light"] == "LED-B3"


def test_maps_are_decoded_by_their_own_scale(tmp_path: Path) -> None:
    maps = [write_map(tmp_path / "a.png", "f_mel"), write_map(tmp_path / "b.png", "hemoglobin")]
    (tmp_path / "face_maps.json").write_text(json.dumps({"settings": {}}), "utf-8")
    maps[0] = maps[0].rename(tmp_path / "face_melanin.png")
    out = tmp_path / "deep" / "shader"
    assert main(["shader", "-q", *map(str, maps), "-o", str(out), "--target", "materialx"]) == 0
    text = (out / "skin.mtlx").read_text(encoding="utf-8")
    assert 'value="../../face_melanin.png"' in text and 'value="../../b.png"' in text
    assert f'value="{1e-6 * 65535!r}"' in text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--target", "unreal"), "got 'unreal'"),
        (("--size", "8x128"), "got 8x128"),
        (("--size", "big"), "got 'big'"),
        (("--light", "candle"), "no light 'candle'"),
        (("--blender", "no-such-program"), "no program no-such-program"),
        (("absent.png",), "absent.png cannot be read"),
    ],
)
def test_bad_flags_are_one_sentence_and_nothing_is_written(
    words: tuple[str, ...],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out"
    assert said in refuse(capsys, *words, "-o", out)
    assert not out.exists()


def test_files_that_are_there_stay(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mine = tmp_path / "skin.glsl"
    mine.write_text("mine", encoding="utf-8")
    flags = ("-o", tmp_path, "--target", "glsl", "--size", "16x16")
    assert "--overwrite" in refuse(capsys, *flags)
    assert [each.name for each in tmp_path.iterdir()] == ["skin.glsl"]
    assert mine.read_text(encoding="utf-8") == "mine"
    assert main(["shader", "-q", *map(str, flags), "--overwrite"]) == 0
    assert "skin_albedo" in mine.read_text(encoding="utf-8")


def test_other_pictures_are_no_maps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_png(tmp_path / "photo.png", np.zeros((4, 4, 3), np.uint8))
    (tmp_path / "words.png").write_text("words", encoding="utf-8")
    melanin = write_map(tmp_path / "m.png", "melanin")
    shading = write_map(tmp_path / "s.png", "shading")
    broken = write_map(tmp_path / "b.png", "f_blood", "nan")
    out = ("-o", tmp_path / "out")
    assert "no map with a scale" in refuse(capsys, tmp_path / "photo.png", *out)
    assert "is no map of skinnet" in refuse(capsys, tmp_path / "words.png", *out)
    assert "'shading'" in refuse(capsys, shading, *out)
    assert "both maps of the melanin" in refuse(capsys, melanin, melanin, *out)
    assert "no map of the hemoglobin" in refuse(capsys, melanin, *out)
    assert "which is no number" in refuse(capsys, melanin, broken, *out)
    assert not (tmp_path / "out").exists()


def test_a_blender_that_fails_leaves_the_other_files_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "python-broken"
    broken.write_text("#!/bin/sh\necho no module bpy >&2\nexit 1\n", encoding="utf-8")
    broken.chmod(0o755)
    out = tmp_path / "out"
    flags = ("--target", "blender", "--size", "16x16", "--blender", broken, "-o", out)
    assert "no module bpy" in refuse(capsys, *flags)
    names = {each.name for each in out.iterdir()}
    assert names == {"skin_table.exr", "skin_table.png", "skin_blender.py"}


def test_a_blender_that_nobody_named_may_fail(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "bin" / "blender"
    broken.parent.mkdir()
    broken.write_text("#!/bin/sh\necho no display >&2\nexit 1\n", encoding="utf-8")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", str(broken.parent), prepend=":")
    out = tmp_path / "out"
    assert main(["shader", "--json", "--size", "16x16", "-o", str(out)]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert {Path(each) for each in found["files"]} == {*out.iterdir()}
    assert not (out / "skin.blend").exists() and (out / "skin_blender.py").exists()
    assert "no display" in said.err and found["notes"]


@pytest.fixture(scope="module")
def inverted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small texture under light A, as two UDIM tiles and alone, with its maps."""
    folder: Path = tmp_path_factory.mktemp("inverted")
    pixels = np.full((8, 8, 3), (200, 160, 140), np.uint8)
    pixels[0] = (0, 90, 20)
    for name in ("one.png", "set.1001.png", "set.1002.png"):
        write_png(folder / name, pixels)
    for name in ("one.png", "set.<UDIM>.png"):
        assert main(["invert", "-q", str(folder / name), "--light", "A", "-o", str(folder)]) == 0
    return folder


def run(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[Any, str]:
    flags = ("--json", "--size", "16x16", "--target", "materialx", "--target", "osl")
    assert main(["shader", *flags, *map(str, words)]) == 0
    said = capsys.readouterr()
    return json.loads(said.out), said.err


def test_the_table_has_the_light_of_the_maps(
    inverted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    maps = inverted / "one_maps.json"
    found, said = run(capsys, maps, "-o", tmp_path / "a")
    assert (found["light"], found["camera"], said) == ("A", "observer", "")
    assert found["maps"].keys() == {"melanin", "hemoglobin", "skin", "original"}
    assert Path(found["maps"]["original"]).samefile(inverted / "one.png")
    pigments = [inverted / f"one_{name}.png" for name in ("melanin", "hemoglobin")]
    found, said = run(capsys, *pigments, "-o", tmp_path / "b")
    assert (found["light"], said) == ("A", "")
    assert found["maps"].keys() == {"melanin", "hemoglobin"}
    found, said = run(capsys, maps, "--light", "D65", "-o", tmp_path / "c")
    assert "were made for light A" in said and "for D65 and observer" in said
    assert found["maps"].keys() == {"melanin", "hemoglobin", "skin"}


def test_the_table_has_the_colour_transform_of_the_maps(
    inverted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plain, moved = inverted / "one_maps.json", inverted / "moved_maps.json"
    record = json.loads(plain.read_text("utf-8"))
    record["transform"] = [[0, 2, 0], [1, 0, 0], [0, 0, 1]]
    moved.write_text(json.dumps(record), "utf-8")
    run(capsys, plain, "-o", tmp_path / "a")
    run(capsys, moved, "-o", tmp_path / "b")
    red, green, blue = np.moveaxis(read_table(tmp_path / "a"), -1, 0)
    np.testing.assert_allclose(
        read_table(tmp_path / "b"), np.stack([2 * green, red, blue], -1), rtol=1e-5, atol=1e-6
    )


def test_tiles_of_a_set_are_one_map(
    inverted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found, _ = run(capsys, inverted / "set_maps.json", "-o", tmp_path / "a")
    assert found["maps"]["melanin"].endswith("set_melanin.<UDIM>.png")
    assert found["maps"]["original"].endswith("set.<UDIM>.png")
    text = (tmp_path / "a" / "skin.mtlx").read_text("utf-8")
    assert "set_melanin.&lt;UDIM&gt;.png" in text
    tiles = [inverted / f"set_{each}.1002.png" for each in ("melanin", "hemoglobin")]
    found, _ = run(capsys, *tiles, "-o", tmp_path / "b")
    assert found["maps"]["melanin"].endswith("set_melanin.<UDIM>.png")


def test_a_texture_that_is_not_the_one_of_the_maps_is_refused(
    inverted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file in inverted.glob("one*"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    maps, texture, out = tmp_path / "one_maps.json", tmp_path / "one.png", tmp_path / "out"
    write_png(texture, np.zeros((8, 8, 3), np.uint8))
    assert "has changed since" in refuse(capsys, maps, "-o", out)
    texture.unlink()
    assert "is not there; give it by --original" in refuse(capsys, maps, "-o", out)
    write_png(texture, np.zeros((9, 8, 3), np.uint8))
    assert "is 8 x 9 and its maps are 8 x 8" in refuse(
        capsys, maps, "--original", texture, "-o", out
    )
    assert "needs the maps" in refuse(capsys, "--original", texture, "-o", out)
    (tmp_path / "two.<UDIM>.png").write_bytes(b"")
    assert "a set of tiles without" in refuse(capsys, tmp_path / "two.<UDIM>.png", "-o", out)
    both = (inverted / "one_melanin.png", inverted / "set_hemoglobin.1001.png")
    assert "maps of one texture" in refuse(capsys, *both, "-o", out)
    broken = tmp_path / "bad_maps.json"
    broken.write_text(json.dumps({"tiles": []}), "utf-8")
    assert "is not a NAME_maps.json" in refuse(capsys, broken, "-o", out)
    assert not out.exists()
    original = ("--original", inverted / "one.png", "-o", out)
    found, _ = run(capsys, maps, *original)
    assert found["maps"]["original"] == str(inverted / "one.png")


@pytest.mark.slow
def test_blender_saves_the_node_group_with_its_table(inverted: Path, tmp_path: Path) -> None:
    if not BLENDER.exists():
        pytest.skip("Blender is not installed: make blender")
    flags = ["--target", "blender", "--size", "32x32", "--blender", str(BLENDER)]
    maps = str(inverted / "set_maps.json")
    assert main(["shader", "-q", maps, "-o", str(tmp_path / "out"), *flags]) == 0
    found = open_blend(tmp_path / "out" / "skin.blend")
    assert found["group"] == ["Skin"] and found["material"] == ["Skin"]
    assert found["packed"] == {"FILE": [True], "TILED": [False] * 4}
    assert found["tiles"] == [[1001, 1002]] * 4
    assert found["driver"] == "frame * base / fps"
    assert math.isclose(found["time"], 48 / 24, abs_tol=1e-6)


def open_blend(path: Path) -> Any:
    code = f"""
import bpy, json
bpy.ops.wm.open_mainfile(filepath={str(path)!r})
material = bpy.data.materials["Skin"]
bpy.ops.mesh.primitive_plane_add()
bpy.context.object.data.materials.append(material)
bpy.context.scene.frame_set(48)
tree = material.evaluated_get(bpy.context.evaluated_depsgraph_get()).node_tree
group = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup")
print("found", json.dumps({{
  "group": [each.name for each in bpy.data.node_groups],
  "material": [each.name for each in bpy.data.materials if each.name == "Skin"],
  "packed": {{kind: [each.packed_file is not None for each in bpy.data.images
    if each.filepath and each.source == kind] for kind in ("FILE", "TILED")}},
  "tiles": [[tile.number for tile in each.tiles] for each in bpy.data.images
    if each.source == "TILED"],
  "driver": material.node_tree.animation_data.drivers[0].driver.expression,
  "time": group.inputs["Time"].default_value}}))
"""
    done = subprocess.run([BLENDER, "-c", code], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.partition("found ")[2].splitlines()[0])
