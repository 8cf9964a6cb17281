"""Parts of a mesh file as trimesh reads them, each with its own vertices and material."""

import warnings
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import trimesh
from jaxtyping import Float, Int, UInt8
from trimesh.visual import TextureVisuals

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.mesh._texture_file import Texture

MESH_SUFFIXES = (".obj", ".ply", ".glb", ".gltf", ".stl")
"""Suffixes of the mesh files that can be read."""


class MeshGeometry(NamedTuple):
    """Vertices, repeated where texture coordinates differ, and triangles."""

    vertices: Float[np.ndarray, "_ 3"]
    triangles: Int[np.ndarray, "_ 3"]


class MeshPart(NamedTuple):
    """One part of a file: its geometry, texture coordinates, and the material's texture and colour.

    `uv` has a row per vertex. `colour` is sRGB.
    """

    geometry: MeshGeometry
    uv: Float[np.ndarray, "_ 2"] | None
    texture: Texture | None
    colour: UInt8[np.ndarray, "3"]


class MeshContent(NamedTuple):
    """The parts of a file, and what was assumed when they were read.

    `listed` holds the positions in the file's order (it may be empty: then that of the parts).
    `names_pictures` tells whether the file's materials name a picture, of whatever kind.
    """

    parts: list[MeshPart]
    notes: list[str]
    names_pictures: bool
    listed: Float[np.ndarray, "listed 3"]


def read_parts(path: Path) -> list[MeshPart]:
    """Read the parts of a file that have triangles, in the file's frame.

    Raises:
        InputError: For a file that is missing, of another kind, damaged, or without triangles.
    """
    check_mesh_file(path)
    return [convert_part(path, each) for each in load_geometries(path)]


def load_geometries(path: Path, content: BytesIO | None = None) -> list[Any]:
    """Load trimesh's meshes in a file, or in `content` in its place, in the file's frame.

    Raises:
        InputError: If the file is damaged, or has no triangles.
    """
    scene = _load_scene(path, content)
    try:
        geometries = [_place(scene, node) for node in scene.graph.nodes_geometry]
    except READ_ERRORS as error:
        raise _unreadable(path, error) from error
    solid = [each for each in geometries if isinstance(each, trimesh.Trimesh) and len(each.faces)]
    if not solid:
        raise refuse_points(path, sum(len(each.vertices) for each in geometries))
    return solid


def concatenate(geometries: list[MeshGeometry]) -> MeshGeometry:
    """Concatenate the vertices and triangles of several geometries."""
    starts = np.cumsum([0] + [len(each.vertices) for each in geometries[:-1]])
    triangles = [each.triangles + start for each, start in zip(geometries, starts, strict=True)]
    return MeshGeometry(
        np.concatenate([each.vertices for each in geometries]), np.concatenate(triangles)
    )


def check_mesh_file(path: Path) -> None:
    """Raise `InputError` if a file is missing, or its suffix is not one of `MESH_SUFFIXES`."""
    if not path.is_file():
        raise InputError(f"There is no mesh {path}; check the path.")
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InputError(
            f"{path} is not a mesh file that can be read; give one of {', '.join(MESH_SUFFIXES)}."
        )


def check_range(path: Path, triangles: Int[np.ndarray, "_ 3"], vertices: int) -> None:
    """Raise `InputError` if triangles refer to vertices that are not there."""
    low, high = triangles.min(initial=0), triangles.max(initial=-1)
    if low < 0 or high >= vertices:
        raise InputError(
            f"{path} has a face with vertex {high if low >= 0 else low}, and "
            f"{vertices:,} vertices; it is damaged or cut short, export it again."
        )


def refuse_points(path: Path, points: int) -> InputError:
    """Make the error for a file without triangles."""
    return InputError(f"{path} has no faces, only {points:,} points; export it as a triangle mesh.")


def _load_scene(path: Path, content: BytesIO | None) -> Any:
    kind = path.suffix.lower()[1:]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return trimesh.load_scene(content or path, file_type=kind, process=False)
    except READ_ERRORS as error:
        raise _unreadable(path, error) from error


def _place(scene: Any, node: str) -> Any:
    transform, name = scene.graph[node]
    geometry = scene.geometry[name]
    if np.array_equal(transform, np.eye(4)):
        return geometry
    return geometry.copy().apply_transform(transform)


def convert_part(path: Path, geometry: Any) -> MeshPart:
    """Convert a mesh of trimesh to a part, without its picture."""
    mesh = MeshGeometry(
        np.asarray(geometry.vertices, np.float64), np.asarray(geometry.faces, np.int64)
    )
    check_range(path, mesh.triangles, len(mesh.vertices))
    visual = geometry.visual
    if not isinstance(visual, TextureVisuals):
        return MeshPart(mesh, None, None, _rgb(visual.main_color))
    known = visual.uv is not None and len(visual.uv) == len(mesh.vertices)
    uv = np.asarray(visual.uv, np.float64)[:, :2] if known else None
    return MeshPart(mesh, uv, None, _rgb(visual.material.main_color))


def _rgb(colour: Any) -> UInt8[np.ndarray, "3"]:
    return np.asarray(colour, np.uint8)[:3]


def _unreadable(path: Path, error: BaseException) -> InputError:
    return InputError(
        f"{path} cannot be read as a mesh ({type(error).__name__}: {error}); export it again."
    )
