"""Nodes of glTF: which meshes the scene has, and where they stand."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.mesh._gltf.container import GltfFile

Transform = Float[np.ndarray, "4 4"]


class Instance(NamedTuple):
    """A mesh at a node. `transform` maps to the scene; a skin's joints replace it."""

    mesh: int
    node: dict[str, Any]
    transform: Transform


def list_instances(file: GltfFile, transforms: dict[int, Transform]) -> list[Instance]:
    """List the meshes of the default scene, else of the first, in the order of the nodes.

    Without a scene every node counts, and without nodes every mesh.
    """
    if not file.document.get("nodes"):
        return [Instance(n, {}, np.eye(4)) for n in range(len(file.document.get("meshes", [])))]
    instances, todo, done = [], _list_roots(file)[::-1], set()
    while todo:
        number = todo.pop()
        node = file.get("nodes", number)
        if number in done or not _is_visible(node):
            continue
        done.add(number)
        if "mesh" in node:
            instances.append(Instance(node["mesh"], node, transforms[number]))
        todo += node.get("children", [])[::-1]
    return instances


def compute_transforms(file: GltfFile) -> dict[int, Transform]:
    """Compute the transforms from every node to the scene."""
    nodes = file.document.get("nodes", [])
    parents = {
        child: parent for parent, node in enumerate(nodes) for child in node.get("children", [])
    }
    known: dict[int, Transform] = {}
    for number in range(len(nodes)):
        chain: list[int] = []
        above: int | None = number
        while above is not None and above not in known:
            if len(chain) > len(nodes):
                raise file.damage(f"its node {number} is its own ancestor")
            chain.append(above)
            above = parents.get(above)
        transform = np.eye(4) if above is None else known[above]
        for each in reversed(chain):
            known[each] = transform = transform @ _compute_local(file, each)
    return known


def describe_scene(file: GltfFile) -> list[str]:
    """Describe what was left out: other scenes, hidden nodes, animations."""
    document, notes = file.document, []
    scenes = document.get("scenes", [])
    if len(scenes) > 1:
        number = document.get("scene", 0)
        name = scenes[number].get("name", f"number {number}")
        notes.append(f"{file.path} has {len(scenes)} scenes; {name} is read, as the file states.")
        if "scene" not in document:
            notes[-1] = f"{file.path} has {len(scenes)} scenes and states none; {name} is read."
    if not all(_is_visible(node) for node in document.get("nodes", [])):
        notes.append(f"{file.path} has hidden nodes; what hangs on them is left out.")
    if document.get("animations"):
        notes.append(f"{file.path} has animations; the mesh is left at rest, as its nodes state.")
    return notes


def _list_roots(file: GltfFile) -> list[int]:
    if file.document.get("scenes"):
        scene = file.get("scenes", file.document.get("scene", 0))
        return list(scene.get("nodes", []))
    nodes = file.document["nodes"]
    children = {child for node in nodes for child in node.get("children", [])}
    return [number for number in range(len(nodes)) if number not in children]


def _is_visible(node: dict[str, Any]) -> bool:
    stated = node.get("extensions", {}).get("KHR_node_visibility", {})
    return bool(stated.get("visible", True))


def _compute_local(file: GltfFile, number: int) -> Transform:
    node = file.get("nodes", number)
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    transform = np.eye(4)
    rotation = _compute_rotation(np.array(node.get("rotation", [0, 0, 0, 1]), np.float64))
    transform[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]), np.float64)
    transform[:3, 3] = node.get("translation", [0, 0, 0])
    return transform


def _compute_rotation(quaternion: Float[np.ndarray, "4"]) -> Float[np.ndarray, "3 3"]:
    length = np.linalg.norm(quaternion)
    if length == 0:
        return np.eye(3)
    vector, w = quaternion[:3] / length, quaternion[3] / length
    cross = np.cross(np.eye(3), vector)
    rotation: Float[np.ndarray, "3 3"] = np.eye(3) + 2 * (w * cross + cross @ cross)
    return rotation
