"""Containers of glTF: JSON, chunks, buffers and URIs."""

import struct
from pathlib import Path

import numpy as np
import pytest
from gltf_files import GltfBuilder

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import GltfFile, open_gltf

DATA = bytes(range(12))


def build() -> GltfBuilder:
    made = GltfBuilder()
    made.add_view(DATA)
    return made


def test_views_of_both_forms(tmp_path: Path) -> None:
    made = build()
    made.document["bufferViews"].append({"buffer": 0, "byteOffset": 4, "byteLength": 3})
    for path in (made.write_glb(tmp_path / "a.glb"), made.write_gltf(tmp_path / "a.gltf", "a.bin")):
        file = open_gltf(path)
        assert file.read_view(0) == DATA and file.read_view(1) == DATA[4:7]
        with pytest.raises(InputError, match="has 2 bufferViews, and refers to number 2"):
            file.read_view(2)


@pytest.mark.parametrize("padding", [0, 1, 3])
@pytest.mark.parametrize("counted", [True, False])
def test_chunks_whose_sizes_are_no_multiples_of_four(
    tmp_path: Path, padding: int, counted: bool
) -> None:
    text = b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":3}]'
    text += b" " * ((1 - len(text)) % 4) + b"}"
    text += b" " * (-(len(text) + padding) % 4)
    assert (len(text) + padding) % 4 == 0
    body = struct.pack("<I4s", len(text) + padding * counted, b"JSON") + text + b" " * padding
    body += struct.pack("<I4s", 3, b"BIN\0") + b"abc"
    (tmp_path / "a.glb").write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
    assert open_gltf(tmp_path / "a.glb").binary == b"abc"


def test_a_byte_order_mark_and_bytes_after_the_end_are_harmless(tmp_path: Path) -> None:
    (tmp_path / "a.gltf").write_text('{"asset": {"version": "2.0"}}', encoding="utf-8-sig")
    assert open_gltf(tmp_path / "a.gltf").document["asset"]["version"] == "2.0"
    path = build().write_glb(tmp_path / "a.glb")
    path.write_bytes(path.read_bytes() + b"\0\0\0")
    assert open_gltf(path).read_view(0) == DATA


@pytest.mark.parametrize(
    ("uri", "data"),
    [
        ("data:;base64,YWJj", b"abc"),
        ("data:application/octet-stream;base64,YWJjZA", b"abcd"),
        ("data:x;base64,YWJj\n ZA==", b"abcd"),
        ("data:;base64,-_-_", b"\xfb\xff\xbf"),
        ("data:;base64,YWJj%3D", b"abc"),
        ("data:,a%20b", b"a b"),
    ],
)
def test_data_uris(uri: str, data: bytes) -> None:
    assert GltfFile(Path("a.gltf"), {}).read_uri(uri, "buffer") == data


@pytest.mark.parametrize(
    ("uri", "fault"),
    [
        ("data:nothing", "has no data"),
        ("data:;base64,a", "is not base64"),
        ("data:;base64,%%%%", "is not base64"),
        ("https://a.example/b.bin", "by the address https://a.example/b.bin; download it"),
        ("none.bin", "names the buffer 'none.bin', and there is no such file"),
    ],
)
def test_uris_of_nothing(tmp_path: Path, uri: str, fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        GltfFile(tmp_path / "a.gltf", {}).read_uri(uri, "buffer")


def test_a_short_buffer_is_damage(tmp_path: Path) -> None:
    path = build().write_gltf(tmp_path / "a.gltf", "a.bin")
    (tmp_path / "a.bin").write_bytes(DATA[:5])
    with pytest.raises(InputError, match=r"buffer 0 \(a\.bin\) has 5 of 12 bytes"):
        open_gltf(path).read_view(0)


def test_a_buffer_without_data_is_damage(tmp_path: Path) -> None:
    made = build()
    path = made.write_glb(tmp_path / "a.glb")
    file = open_gltf(path)
    without = GltfFile(path, file.document)
    with pytest.raises(InputError, match="its buffer 0 has no data"):
        without.read_view(0)
    assert np.frombuffer(file.read_view(0), np.uint8).sum() == sum(DATA)
