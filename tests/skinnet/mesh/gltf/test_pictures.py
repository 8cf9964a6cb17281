"""Pictures of glTF textures: where they are, factor and alpha."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import GltfBuilder, checks, encode
from PIL import Image

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import open_gltf
from skinnet.mesh._gltf.materials import read_material
from skinnet.mesh._gltf.pictures import read_base_picture


def read(data: bytes, folder: Path, **material: Any) -> np.ndarray:
    made = GltfBuilder()
    made.add_material(made.add_picture(data))
    made.document["materials"][0].update(material)
    file = open_gltf(made.write_glb(folder / "a.glb"))
    return read_base_picture(file, read_material(file, 0))


def test_the_content_decides_the_format(tmp_path: Path) -> None:
    # Named image/png.
    data = encode(checks(), "JPEG", quality=100, subsampling=0)
    assert np.abs(read(data, tmp_path) - checks().astype(int)).max() <= 6
    grey = checks()[..., 0]
    assert np.array_equal(read(encode(grey), tmp_path), np.repeat(grey[..., None], 3, 2))


def test_sixteen_bits_and_palettes(tmp_path: Path) -> None:
    grey = checks()[..., 0].astype(np.uint16) * 257
    assert np.array_equal(read(encode(grey), tmp_path)[..., 0], checks()[..., 0])
    palette = np.array(Image.fromarray(checks()).quantize(16).convert("RGB"))
    image = Image.fromarray(checks()).quantize(16)
    image.save(tmp_path / "p.png", transparency=0)
    assert np.array_equal(read((tmp_path / "p.png").read_bytes(), tmp_path), palette)


def test_an_orientation_is_not_applied(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    assert read(encode(checks(2, 4), "JPEG", exif=exif), tmp_path).shape == (32, 64, 3)


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        (b"\xabKTX 20\xbb\r\n\x1a\n", "KTX2"),
        (b"\xabKTX 11\xbb\r\n\x1a\n", "KTX"),
        (b"DDS |   ", "DDS"),
        (b"sB\x13\x00", "Basis"),
        (b"text", "not a picture"),
        (encode(checks())[:200], "damaged|cut short|not a picture"),
    ],
)
def test_what_is_no_picture_is_named(tmp_path: Path, data: bytes, fault: str) -> None:
    with pytest.raises(InputError, match=rf"picture inside of .*a\.glb .*({fault})"):
        read(data, tmp_path)


def test_alpha_is_blended_after_the_factor(tmp_path: Path) -> None:
    half = np.zeros((4, 4, 4), np.uint8) + np.array([255, 0, 0, 51], np.uint8)
    base = {"baseColorTexture": {"index": 0}, "baseColorFactor": [0, 1, 1, 0.5]}
    found = read(encode(half), tmp_path, alphaMode="BLEND", pbrMetallicRoughness=base)
    assert (found == 204).all()
    found = read(encode(half), tmp_path, alphaMode="MASK", pbrMetallicRoughness=base)
    assert (found == 255).all()
    shown = {"alphaMode": "MASK", "alphaCutoff": 0.1, "pbrMetallicRoughness": base}
    assert (read(encode(half), tmp_path, **shown) == 0).all()
    assert (read(encode(half), tmp_path, pbrMetallicRoughness=base) == 0).all()


def test_a_normal_map_is_no_base_colour(tmp_path: Path) -> None:
    flat = np.full((16, 16, 3), [128, 128, 255], np.uint8)
    with pytest.raises(InputError, match=r"a\.glb is a normal map by its colours"):
        read(encode(flat), tmp_path)
