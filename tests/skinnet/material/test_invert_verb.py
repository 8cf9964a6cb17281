"""`skinnet invert`, and the way back from its maps."""

import json
from pathlib import Path

import numpy as np
import pytest
from albedo_textures import paint_skin, read_pixels, write_pixels, write_texture
from PIL import Image

from skinnet.cli import main

KINDS = [
    ("a.png", "uint8", False),
    ("a.png", "uint16", True),
    ("a.tif", "uint16", False),
    ("a.tif", "uint8", True),
    ("a.exr", "half", True),
    ("a.exr", "float", False),
]


@pytest.mark.parametrize(("name", "kind", "alpha"), KINDS)
def test_without_an_edit_the_albedo_comes_back_to_its_last_bit(
    tmp_path: Path, name: str, kind: str, alpha: bool
) -> None:
    path = tmp_path / name
    stored = write_texture(path, paint_skin(), kind, alpha)
    assert main(["-q", "invert", str(path)]) == 0
    assert main(["-q", "edit-albedo", str(tmp_path / "skinmaps/a_maps.json")]) == 0
    back = read_pixels(tmp_path / "skinmaps" / f"a_edited{path.suffix}")
    assert back.dtype == stored.dtype and back.shape == stored.shape
    if kind == "float":
        np.testing.assert_allclose(back, stored, rtol=0, atol=1e-7)
    else:
        assert (back == stored).all()


def test_the_maps_are_those_of_the_skin(tmp_path: Path, capsys) -> None:
    path = tmp_path / "face.png"
    write_texture(path, paint_skin(), "uint16")
    assert main(["-q", "invert", str(path), "--json", "-o", str(tmp_path / "maps")]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["melanin"]["median"] == pytest.approx(0.06 * 1.05, rel=0.03)
    assert record["hemoglobin"]["median"] == pytest.approx(0.04 * 1.05, rel=0.03)
    assert all(Path(file).is_file() for file in record["files"])
    melanin = read_pixels(tmp_path / "maps/face_melanin.png")[..., 0] / 65535 * 0.5
    assert np.corrcoef(melanin[30], np.linspace(0.7, 1.4, 48))[0, 1] > 0.98
    skin = read_pixels(tmp_path / "maps/face_skin.png")[..., 0]
    assert (skin[20] == 0).all() and (skin[9] == 0).all() and (skin[30:] == 255).mean() > 0.99
    spread = read_pixels(tmp_path / "maps/face_melanin_sd.png")
    assert (spread[30] > 0).all() and (spread[20] == 0).all()


def test_tiles_of_a_set_and_tiled_files(tmp_path: Path) -> None:
    for tile in (1001, 1002):
        linear = np.concatenate([paint_skin(), np.ones((48, 48, 1), np.float32)], -1)
        write_pixels(tmp_path / f"f.{tile}.exr", linear, "float", ("R", "G", "B", "A"), tile=16)
    assert main(["-q", "invert", str(tmp_path / "f.1001.exr")]) == 0
    record = json.loads((tmp_path / "skinmaps/f_maps.json").read_text())
    assert [one["tile"] for one in record["tiles"]] == [1001, 1002]
    assert (tmp_path / "skinmaps/f_melanin.1002.png").is_file()


def test_other_peoples_files_are_not_replaced(tmp_path: Path) -> None:
    write_texture(tmp_path / "a.png", paint_skin(32), "uint8")
    folder = tmp_path / "skinmaps"
    folder.mkdir()
    (folder / "a_skin.png").write_bytes(b"mine")
    for _ in range(2):
        assert main(["-q", "invert", str(tmp_path / "a.png")]) == 0
    assert (folder / "a_skin.png").read_bytes() == b"mine"
    assert sorted(one.name for one in folder.glob("*.json")) == ["a-2_maps.json"]


def test_a_fitted_factor_is_found_again(tmp_path: Path) -> None:
    skin = 0.7 * np.delete(paint_skin(80), [3, 9, 20], 0)
    write_texture(tmp_path / "a.tif", skin, "uint16")
    assert main(["-q", "invert", str(tmp_path / "a.tif"), "--calibration", "exposure"]) == 0
    record = json.loads((tmp_path / "skinmaps/a_maps.json").read_text())
    assert record["transform"][0][0] == pytest.approx(0.7, abs=0.07)


def _write_bad(folder: Path, kind: str) -> Path:
    path = folder / "bad.png"
    skin = paint_skin(32)
    if kind == "normals":
        angles = np.random.default_rng(0).normal(0, 0.2, (32, 32, 2))
        rgb = np.dstack([angles, np.sqrt(1 - (angles**2).sum(-1).clip(0, 0.9))]) / 2 + 0.5
        write_pixels(path, np.rint(rgb * 255).astype(np.uint8), "uint8", ("R", "G", "B"))
    elif kind == "grey":
        grey = np.random.default_rng(0).integers(0, 255, (32, 32, 1), np.uint8)
        write_pixels(path, np.repeat(grey, 3, 2), "uint8", ("R", "G", "B"))
    elif kind == "half a set":
        for tile in (1001, 1003):
            write_texture(folder / f"bad.{tile}.png", skin, "uint8")
        return folder / "bad.<UDIM>.png"
    elif kind == "channels":
        path = folder / "bad.exr"
        write_pixels(path, skin, "half", ("X", "Y", "Z"))
    elif kind == "more channels":
        path = folder / "bad.exr"
        five = np.concatenate([skin, skin[..., :2]], -1)
        write_pixels(path, five, "half", ("R", "G", "B", "A", "id"))
    elif kind == "cut short":
        write_texture(path, skin, "uint16")
        path.write_bytes(path.read_bytes()[:2000])
    elif kind == "black":
        write_texture(path, 0 * skin, "uint8")
    elif kind == "inks":
        path = folder / "bad.tif"
        pixels = np.rint(255 * skin).astype(np.uint8)
        Image.fromarray(pixels).convert("CMYK").save(path)
    elif kind == "Lab":
        path = folder / "bad.tif"
        Image.fromarray(np.full((32, 32, 3), (160, 140, 150), np.uint8), "LAB").save(path)
    elif kind == "text":
        path.write_text("no picture")
    return path


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("normals", "looks like a normal map"),
        ("grey", "is grey, as roughness"),
        ("half a set", "1002 of the set is missing"),
        ("channels", "has the channels X, Y, Z"),
        ("more channels", "channels beside R, G, B and A: id"),
        ("cut short", "damaged or cut short"),
        ("black", "black or transparent everywhere"),
        ("inks", "stores its colours as CMYK"),
        ("Lab", "stores its colours as CIELAB"),
        ("text", "not a texture that can be read"),
        ("absent", "There is no file"),
    ],
)
@pytest.mark.parametrize("verb", ["invert", "edit-albedo"])
def test_bad_input_is_one_sentence_and_leaves_nothing(
    tmp_path: Path, capsys, kind: str, words: str, verb: str
) -> None:
    path = _write_bad(tmp_path, kind)
    before = sorted(tmp_path.rglob("*.*"))
    words_of_edit = ["--melanin", "2"] if verb == "edit-albedo" else []
    assert main([verb, str(path), *words_of_edit]) == 2
    error = capsys.readouterr().err
    assert words in error and len(error.strip().splitlines()) == 1
    assert sorted(tmp_path.rglob("*.*")) == before


def test_baked_highlights_are_said(tmp_path: Path, capsys) -> None:
    skin = paint_skin(64)
    skin[30:40, 30:40] += 0.25
    write_texture(tmp_path / "a.png", skin, "uint16")
    assert main(["invert", str(tmp_path / "a.png")]) == 0
    assert "brighter and whiter than skin" in capsys.readouterr().err


def test_skin_whose_colours_have_no_hemoglobin_is_said(tmp_path: Path, capsys) -> None:
    yellow = paint_skin(48) * np.float32([0.9, 1.04, 0.9])
    write_texture(tmp_path / "a.png", yellow, "uint16")
    assert main(["invert", str(tmp_path / "a.png")]) == 0
    assert "of the skin has the least or the most hemoglobin" in capsys.readouterr().err
    write_texture(tmp_path / "b.png", paint_skin(48), "uint16")
    assert main(["invert", str(tmp_path / "b.png")]) == 0
    assert "the most hemoglobin" not in capsys.readouterr().err


def test_what_is_no_number_is_no_skin_and_stays(tmp_path: Path, capsys) -> None:
    albedo = np.full((64, 64, 3), (0.5, 0.27, 0.18), np.float32)
    albedo[0], albedo[1, 0] = np.nan, np.inf
    stored = write_texture(tmp_path / "a.exr", albedo, "float")
    assert main(["edit-albedo", str(tmp_path / "a.exr"), "--melanin", "2"]) == 0
    assert "are not numbers" in capsys.readouterr().err
    edited = read_pixels(tmp_path / "a_edited.exr")
    np.testing.assert_array_equal(edited[0], stored[0])
    assert edited[1, 0, 0] == np.inf and (edited[2:] < stored[2:]).all()
    assert main(["invert", str(tmp_path / "a.exr")]) == 0
    assert "65 texels are not numbers" in capsys.readouterr().err
