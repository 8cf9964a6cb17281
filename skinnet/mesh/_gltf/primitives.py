"""Primitives of glTF as triangles, placed in the scene."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._gltf.accessors import read_accessor
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.extensions import refuse_compression
from skinnet.mesh._gltf.nodes import Instance, Transform
from skinnet.mesh._gltf.skins import compute_skinning
from skinnet.mesh._mesh_parts import MeshGeometry, check_range

_READ = ("POSITION", "TEXCOORD", "COLOR")
_TRIANGLES, _STRIP, _FAN = 4, 5, 6

# Primitives have different numbers of vertices.
Coordinates = Float[np.ndarray, "_ 2"]
Colours = Float[np.ndarray, "_ 3"]


class Primitive(NamedTuple):
    """A primitive in the scene. Without triangles it is points or lines."""

    geometry: MeshGeometry
    material: int | None
    attributes: dict[str, Any]


def read_primitives(
    file: GltfFile, instance: Instance, transforms: dict[int, Transform]
) -> list[Primitive]:
    """Read the primitives of a mesh, as its node places, poses and morphs it."""
    mesh = file.get("meshes", instance.mesh)
    primitives = []
    for primitive in mesh.get("primitives", []):
        attributes = primitive.get("attributes", {})
        if "POSITION" not in attributes:
            continue
        _check_data(file, primitive)
        vertices = _read_positions(
            file, primitive, instance.node.get("weights", mesh.get("weights"))
        )
        triangles = _read_triangles(file, primitive, len(vertices))
        matrices = compute_skinning(file, instance, attributes, transforms)
        if matrices is None:
            matrices = instance.transform[None]
        placed = np.einsum(
            "nij,nj->ni", np.broadcast_to(matrices[:, :3, :3], (len(vertices), 3, 3)), vertices
        )
        # A transform that mirrors turns triangles inside out, and glTF turns them back.
        if np.linalg.det(matrices[:, :3, :3].mean(0)) < 0:
            triangles = triangles[:, ::-1]
        geometry = MeshGeometry(placed + matrices[:, :3, 3], triangles)
        primitives.append(Primitive(geometry, primitive.get("material"), attributes))
    return primitives


def read_attribute(file: GltfFile, primitive: Primitive, name: str) -> Float[np.ndarray, "_ _"]:
    """Read texture coordinates or colours, a row for each vertex; integer colours are fractions."""
    number = primitive.attributes[name]
    values = read_accessor(file, number, name.startswith("COLOR")).astype(np.float64)
    checked: Float[np.ndarray, "_ _"] = _check_count(
        file, name, values, len(primitive.geometry.vertices)
    )
    return checked


def _check_data(file: GltfFile, primitive: dict[str, Any]) -> None:
    """Raise `InputError` if what is read of a primitive is not there, or only compressed."""
    attributes = primitive["attributes"]
    numbers = [attributes[name] for name in attributes if name.startswith(_READ)]
    numbers += [primitive["indices"]] if "indices" in primitive else []
    accessors = [file.get("accessors", number) for number in numbers]
    if all("bufferView" in accessor or "sparse" in accessor for accessor in accessors):
        return
    refuse_compression(file.path, primitive)
    names = ", ".join(primitive.get("extensions", {})) or "no extension"
    raise file.damage(f"a mesh has no data for its vertices, and states {names} in their place")


def _read_positions(
    file: GltfFile, primitive: dict[str, Any], weights: list[float] | None
) -> Float[np.ndarray, "_ 3"]:
    """Read the positions, with the morph targets at the weights that the file states."""
    positions = read_accessor(file, primitive["attributes"]["POSITION"]).astype(np.float64)
    for weight, target in zip(weights or [], primitive.get("targets", []), strict=False):
        if weight and "POSITION" in target:
            moved = read_accessor(file, target["POSITION"])
            positions += weight * _check_count(file, "morph target", moved, len(positions))
    return positions


def _read_triangles(
    file: GltfFile, primitive: dict[str, Any], vertices: int
) -> Int[np.ndarray, "_ 3"]:
    if "indices" in primitive:
        corners = read_accessor(file, primitive["indices"])[:, 0].astype(np.int64)
    else:
        corners = np.arange(vertices)
    triangles = _connect(corners, primitive.get("mode", _TRIANGLES))
    check_range(file.path, triangles, vertices)
    return triangles


def _connect(corners: Int[np.ndarray, "_"], mode: int) -> Int[np.ndarray, "_ 3"]:
    """Connect corners to triangles; strips repeat corners where they are joined."""
    if mode == _TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if mode not in (_STRIP, _FAN) or len(corners) < 3:
        return np.zeros((0, 3), np.int64)
    if mode == _FAN:
        first = np.full(len(corners) - 2, corners[0])
        triangles = np.stack([corners[1:-1], corners[2:], first], 1)
    else:
        triangles = np.stack([corners[:-2], corners[1:-1], corners[2:]], 1)
        triangles[1::2] = triangles[1::2, [0, 2, 1]]
    a, b, c = triangles.T
    return np.asarray(triangles[(a != b) & (b != c) & (c != a)])


def _check_count(file: GltfFile, name: str, values: Any, vertices: int) -> Any:
    if len(values) != vertices:
        raise file.damage(f"a {name} has {len(values):,} rows for {vertices:,} vertices")
    return values
