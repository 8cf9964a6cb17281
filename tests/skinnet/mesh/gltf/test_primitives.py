"""Primitives: triangles of every mode."""

from pathlib import Path

import numpy as np
import pytest
from gltf_files import SQUARE, GltfBuilder

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import open_gltf
from skinnet.mesh._gltf.nodes import Instance
from skinnet.mesh._gltf.primitives import Primitive, read_attribute, read_primitives


def read(made: GltfBuilder, folder: Path, transform: np.ndarray | None = None) -> list[Primitive]:
    file = open_gltf(made.write_glb(folder / "a.glb"))
    instance = Instance(0, {}, np.eye(4) if transform is None else transform)
    return read_primitives(file, instance, {})


@pytest.mark.parametrize(
    ("mode", "corners", "triangles"),
    [
        (4, [0, 1, 2, 3], [[0, 1, 2]]),
        (5, [0, 1, 2], [[0, 1, 2]]),
        (5, [0, 1], []),
        (5, [0, 1, 2, 3, 0], [[0, 1, 2], [1, 3, 2], [2, 3, 0]]),
        (6, [2, 3, 0, 1], [[3, 0, 2], [0, 1, 2]]),
        (1, [0, 1, 2, 3], []),
    ],
)
def test_modes(tmp_path: Path, mode: int, corners: list[int], triangles: list[list[int]]) -> None:
    made = GltfBuilder()
    one = made.add_square(mode=mode)
    one["indices"] = made.add_array(np.array(corners, np.uint8))
    (found,) = read(made, tmp_path)
    assert found.geometry.triangles.tolist() == triangles


def test_a_mirrored_mesh_keeps_its_front(tmp_path: Path) -> None:
    made = GltfBuilder()
    made.add_square()
    (found,) = read(made, tmp_path, np.diag([-1.0, 1, 1, 1]))
    assert np.array_equal(found.geometry.vertices, SQUARE * [-1, 1, 1])
    assert found.geometry.triangles.tolist() == [[2, 1, 0], [3, 2, 0]]


def test_primitives_without_positions_are_skipped(tmp_path: Path) -> None:
    made = GltfBuilder()
    del made.add_square()["attributes"]["POSITION"]
    assert read(made, tmp_path) == []


def test_integer_colours_are_fractions_and_integer_coordinates_are_not(tmp_path: Path) -> None:
    made = GltfBuilder()
    one = made.add_square()
    one["attributes"]["COLOR_0"] = made.add_array(np.full((4, 3), 255, np.uint8))
    one["attributes"]["TEXCOORD_0"] = made.add_array(np.full((4, 2), 255, np.uint8))
    (found,) = read(made, tmp_path)
    file = open_gltf(tmp_path / "a.glb")
    assert read_attribute(file, found, "COLOR_0").max() == 1
    assert read_attribute(file, found, "TEXCOORD_0").max() == 255


@pytest.mark.parametrize("name", ["POSITION", "TEXCOORD_0", "indices"])
def test_vertices_without_data_are_damage(tmp_path: Path, name: str) -> None:
    made = GltfBuilder()
    one = made.add_square()
    number = one["indices"] if name == "indices" else one["attributes"][name]
    del made.document["accessors"][number]["bufferView"]
    with pytest.raises(InputError, match="no data for its vertices, and states no extension"):
        read(made, tmp_path)
    one["extensions"] = {"ACME_packed": {}}
    with pytest.raises(InputError, match="ACME_packed"):
        read(made, tmp_path)
