"""Parts of a mesh file, each with its own vertices and material."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, UInt8

from skinnet.errors import InputError
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


def check_range(path: Path, triangles: Int[np.ndarray, "..."], vertices: int) -> None:
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
