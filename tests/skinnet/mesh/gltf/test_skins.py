"""Skins: vertices follow their joints, weighted."""

from pathlib import Path

import numpy as np
import pytest
from gltf_files import GltfBuilder

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import open_gltf
from skinnet.mesh._gltf.nodes import Instance
from skinnet.mesh._gltf.skins import compute_skinning

TRANSFORMS = {0: np.diag([2.0, 2, 2, 1]), 1: np.eye(4) + np.eye(4, k=3)}


def skin(
    tmp_path: Path, weights: np.ndarray, joints: np.ndarray, bound: bool = False
) -> np.ndarray | None:
    made = GltfBuilder()
    attributes = {"JOINTS_0": made.add_array(joints), "WEIGHTS_0": made.add_array(weights)}
    made.add("skins", joints=[0, 1])
    if bound:
        inverse = np.stack([np.linalg.inv(TRANSFORMS[k]).T.ravel() for k in range(2)])
        made.document["skins"][0]["inverseBindMatrices"] = made.add_array(inverse.astype("f4"))
    file = open_gltf(made.write_glb(tmp_path / "a.glb"))
    return compute_skinning(file, Instance(0, {"skin": 0}, np.eye(4)), attributes, TRANSFORMS)


def test_joints_are_blended(tmp_path: Path) -> None:
    weights = np.array([[1, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 3, 0, 0], [0, 0, 0, 0]], np.float32)
    joints = np.array([[0, 1, 0, 0]] * 4, np.uint16)
    found = skin(tmp_path, weights, joints)
    half = (TRANSFORMS[0] + TRANSFORMS[1]) / 2
    # Weights are scaled to a sum of one; a vertex without any follows the first joint.
    assert np.allclose(found, [TRANSFORMS[0], half, TRANSFORMS[1], TRANSFORMS[0]])
    packed = np.rint(weights.clip(0, 1) * 255).astype(np.uint8)
    assert np.allclose(skin(tmp_path, packed, joints.astype(np.uint8)), found, atol=0.01)


def test_the_pose_in_which_it_was_bound_moves_nothing(tmp_path: Path) -> None:
    weights, joints = np.full((2, 4), 0.25, np.float32), np.array([[0, 1, 0, 1]] * 2, np.uint8)
    assert np.allclose(skin(tmp_path, weights, joints, bound=True), np.eye(4), atol=1e-6)


def test_a_mesh_without_a_skin(tmp_path: Path) -> None:
    file = open_gltf(GltfBuilder().write_glb(tmp_path / "a.glb"))
    assert compute_skinning(file, Instance(0, {}, np.eye(4)), {}, TRANSFORMS) is None


def test_joints_that_are_not_there_are_damage(tmp_path: Path) -> None:
    weights, joints = np.ones((1, 4), np.float32), np.array([[0, 1, 2, 0]], np.uint8)
    with pytest.raises(InputError, match="refers to joint 2 of 2"):
        skin(tmp_path, weights, joints)
