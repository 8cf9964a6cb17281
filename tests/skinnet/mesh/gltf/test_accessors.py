"""Accessors: types, strides, sparse values, and what does not fit."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import COMPONENTS, GltfBuilder

from skinnet.errors import InputError
from skinnet.mesh._gltf.accessors import read_accessor
from skinnet.mesh._gltf.container import open_gltf


def read(made: GltfBuilder, folder: Path, number: int = 0, **options: Any) -> np.ndarray:
    return read_accessor(open_gltf(made.write_glb(folder / "a.glb")), number, **options)


@pytest.mark.parametrize("kind", COMPONENTS)
@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_types(tmp_path: Path, kind: str, width: int) -> None:
    values = np.arange(5 * width).reshape(5, width).astype(kind)
    made = GltfBuilder()
    made.add_array(values)
    found = read(made, tmp_path)
    assert np.array_equal(found, values) and found.dtype == kind


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2"])
def test_normalised_integers_are_fractions(tmp_path: Path, kind: str) -> None:
    limits = np.iinfo(kind)
    made = GltfBuilder()
    made.add_array(np.array([limits.min, 0, limits.max], kind), normalized=True)
    made.add_array(np.array([limits.max], kind))
    assert read(made, tmp_path).ravel().tolist() == [-1.0 if limits.min else 0.0, 0.0, 1.0]
    assert read(made, tmp_path, 1, normalise=True).ravel().tolist() == [1.0]


def test_floats_are_never_normalised(tmp_path: Path) -> None:
    made = GltfBuilder()
    made.add_array(np.array([2.5], np.float32), normalized=True)
    assert read(made, tmp_path).ravel().tolist() == [2.5]


def test_rows_may_be_apart(tmp_path: Path) -> None:
    rows = np.arange(24, dtype=np.float32).reshape(4, 6)
    made = GltfBuilder()
    view = made.add_view(rows.tobytes(), byteStride=24)
    made.add("accessors", bufferView=view, byteOffset=8, componentType=5126, type="VEC3", count=4)
    assert np.array_equal(read(made, tmp_path), rows[:, 2:5])


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"count": 3}, "3 elements of 12 bytes, one every 12, do not fit into the 24 bytes"),
        ({"byteOffset": 4}, "do not fit"),
        ({"byteOffset": -4}, "do not fit"),
        ({"componentType": 5124}, "unknown type 5124 VEC3"),
        ({"type": "VEC9"}, "unknown type 5126 VEC9"),
        ({"bufferView": 5}, "has 1 bufferViews, and refers to number 5"),
    ],
)
def test_what_does_not_fit_is_damage(tmp_path: Path, change: dict[str, Any], fault: str) -> None:
    made = GltfBuilder()
    made.add_array(np.zeros((2, 3), np.float32))
    made.document["accessors"][0].update(change)
    with pytest.raises(InputError, match=fault):
        read(made, tmp_path)


def test_sparse_rows_that_are_not_there_are_damage(tmp_path: Path) -> None:
    made = GltfBuilder()
    made.add_array(np.zeros((2, 3), np.float32))
    rows = {"bufferView": made.add_view(b"\x02"), "componentType": 5121}
    values = {"bufferView": made.add_view(bytes(12))}
    made.document["accessors"][0]["sparse"] = {"count": 1, "indices": rows, "values": values}
    with pytest.raises(InputError, match="replaces element 2 of 2"):
        read(made, tmp_path)
    rows["componentType"] = 5126
    with pytest.raises(InputError, match=r"sparse indices of an unknown type|do not fit"):
        read(made, tmp_path)
