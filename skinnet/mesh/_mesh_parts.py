"""Mesh files as trimesh reads them: parts, each with its own vertices and material."""

import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import trimesh
from jaxtyping import Float, Int, UInt8
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from skinnet.errors import InputError
from skinnet.files import BROKEN
from skinnet.mesh._texture_file import Texture, decode_texture

MESH_SUFFIXES = (".obj", ".ply", ".glb", ".gltf", ".stl")
"""Suffixes of the mesh files that are read."""


class MeshGeometry(NamedTuple):
    """A vertex for each pair of position and texture coordinates, and triangles."""

    vertices: Float[np.ndarray, "_ 3"]
    triangles: Int[np.ndarray, "_ 3"]


class MeshPart(NamedTuple):
    """One geometry of a file; `colour` is its material's, sRGB."""

    corners: MeshGeometry
    uv: Float[np.ndarray, "_ 2"] | None
    picture: Texture | None
    colour: UInt8[np.ndarray, "3"]


def read_parts(path: Path) -> list[MeshPart]:
    """The geometries with triangles of a file, in its frame.

    Raises `InputError` for a file that is missing, of another kind, damaged, or without triangles.
    """
    scene = _scene(path)
    try:
        geometries = [_placed(scene, node) for node in scene.graph.nodes_geometry]
    except BROKEN as error:
        raise _unreadable(path, error) from error
    solid = [each for each in geometries if isinstance(each, trimesh.Trimesh) and len(each.faces)]
    if not solid:
        points = sum(len(each.vertices) for each in geometries)
        raise InputError(
            f"{path} has no faces, only {points:,} points; export it as a triangle mesh."
        )
    return [_part(path, each) for each in solid]


def concatenate(parts: list[MeshGeometry]) -> MeshGeometry:
    """Parts one after the other."""
    starts = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    triangles = [part.triangles + start for part, start in zip(parts, starts, strict=True)]
    return MeshGeometry(np.concatenate([p.vertices for p in parts]), np.concatenate(triangles))


def read_obj_positions(path: Path) -> Float[np.ndarray, "vertices 3"]:
    """The `v` lines of an OBJ file in its order; trimesh's is by material and seam."""
    with path.open("rb") as file:
        lines = [line for line in file if line.startswith((b"v ", b"v\t"))]
    if not lines:
        return np.zeros((0, 3))
    try:
        positions: Float[np.ndarray, "vertices 3"] = np.loadtxt(lines, usecols=(1, 2, 3), ndmin=2)
    except ValueError as error:
        raise InputError(f"{path} has a damaged line among its vertices: {error}.") from error
    return positions


def _scene(path: Path) -> Any:
    kind = path.suffix.lower()
    if not path.is_file():
        raise InputError(f"There is no mesh {path}; check the path.")
    if kind not in MESH_SUFFIXES:
        raise InputError(f"{path} is no mesh that is read; give one of {', '.join(SUFFIXES)}.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return trimesh.load_scene(path, file_type=kind[1:], process=False)
    except BROKEN as error:
        raise _unreadable(path, error) from error


def _placed(scene: Any, node: str) -> Any:
    transform, name = scene.graph[node]
    geometry = scene.geometry[name]
    if np.array_equal(transform, np.eye(4)):
        return geometry
    return geometry.copy().apply_transform(transform)


def _part(path: Path, geometry: Any) -> MeshPart:
    corners = MeshGeometry(
        np.asarray(geometry.vertices, np.float64), np.asarray(geometry.faces, np.int64)
    )
    low, high = corners.triangles.min(), corners.triangles.max()
    if low < 0 or high >= len(corners.vertices):
        raise InputError(
            f"{path} has a face with vertex {high if low >= 0 else low}, and "
            f"{len(corners.vertices):,} vertices; it is damaged or cut short, export it again."
        )
    visual = geometry.visual
    if not isinstance(visual, TextureVisuals):
        return MeshPart(corners, None, None, _rgb(visual.main_color))
    known = visual.uv is not None and len(visual.uv) == len(corners.vertices)
    uv = np.asarray(visual.uv, np.float64)[:, :2] if known else None
    return MeshPart(corners, uv, _picture(path, visual.material), _rgb(visual.material.main_color))


def _picture(path: Path, material: Any) -> Texture | None:
    image = material.baseColorTexture if isinstance(material, PBRMaterial) else material.image
    # trimesh makes a picture of four pixels for a material without one; it comes from no file.
    if not isinstance(image, Image.Image) or image.format is None:
        return None
    return decode_texture(image, f"The texture of {path}")


def _rgb(colour: Any) -> UInt8[np.ndarray, "3"]:
    return np.asarray(colour, np.uint8)[:3]


def _unreadable(path: Path, error: BaseException) -> InputError:
    return InputError(
        f"{path} cannot be read as a mesh ({type(error).__name__}: {error}); export it again."
    )
