"""Nodes: their transforms, and which meshes a scene has."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.nodes import compute_transforms, describe_scene, list_instances


def make(**document: Any) -> GltfFile:
    return GltfFile(Path("a.gltf"), document)


def test_transforms_agree_with_trimesh() -> None:
    rng = np.random.default_rng(0)
    quaternion = rng.normal(size=4)
    node = {"rotation": quaternion.tolist(), "scale": [1, 2, 3], "translation": [4, 5, 6]}
    found = compute_transforms(make(nodes=[node]))[0]
    turn = trimesh.transformations.quaternion_matrix(quaternion[[3, 0, 1, 2]])
    expected = trimesh.transformations.translation_matrix([4, 5, 6]) @ turn @ np.diag([1, 2, 3, 1])
    assert np.allclose(found, expected)
    columns = expected.T.ravel().tolist()
    chain = [{"matrix": columns, "children": [2]}, {"rotation": [0, 0, 0, 0]}, {"matrix": columns}]
    found = compute_transforms(make(nodes=chain))
    assert np.allclose(found[2], expected @ expected) and np.array_equal(found[1], np.eye(4))


def test_a_circle_of_nodes_is_damage() -> None:
    with pytest.raises(InputError, match="its own ancestor"):
        compute_transforms(make(nodes=[{"children": [1]}, {"children": [0]}]))


def list_meshes(file: GltfFile) -> list[int]:
    return [instance.mesh for instance in list_instances(file, compute_transforms(file))]


def test_meshes_are_those_of_the_scene() -> None:
    nodes = [{"mesh": 0, "children": [1]}, {"mesh": 1}, {"mesh": 2}, {"mesh": 0}]
    scenes = [{"nodes": [0]}, {"nodes": [3, 2], "name": "second"}]
    assert list_meshes(make(nodes=nodes, scenes=scenes)) == [0, 1]
    assert list_meshes(make(nodes=nodes, scenes=scenes, scene=1)) == [0, 2]
    assert list_meshes(make(nodes=nodes)) == [0, 1, 2, 0]
    assert list_meshes(make(meshes=[{}, {}])) == [0, 1]
    with pytest.raises(InputError, match="has 2 scenes, and refers to number 2"):
        list_meshes(make(nodes=nodes, scenes=scenes, scene=2))


def test_hidden_nodes_are_left_out_and_said() -> None:
    hidden = {"extensions": {"KHR_node_visibility": {"visible": False}}, "children": [1]}
    file = make(nodes=[hidden, {"mesh": 0}, {"mesh": 1}])
    assert list_meshes(file) == [1]
    assert "hidden nodes" in describe_scene(file)[0]


def test_what_is_left_out_is_described() -> None:
    assert describe_scene(make(nodes=[{}], scenes=[{}])) == []
    (note,) = describe_scene(make(scenes=[{}, {"name": "head"}], scene=1))
    assert note == "a.gltf has 2 scenes; head is read, as the file states."
    (note,) = describe_scene(make(scenes=[{}, {}]))
    assert note == "a.gltf has 2 scenes and states none; number 0 is read."
    (note,) = describe_scene(make(animations=[{}]))
    assert "left at rest" in note
