"""Parts from faces whose corners have a vertex and, perhaps, a texture coordinate."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.mesh._mesh_parts import MeshGeometry, MeshPart

GREY = np.array([102, 102, 102], np.uint8)
"""Colour of a part whose material states none."""


class Faces(NamedTuple):
    """Triangles; `uv_triangles` is -1 where one has no texture coordinates."""

    vertices: Float[np.ndarray, "vertices 3"]
    coordinates: Float[np.ndarray, "coordinates 2"]
    triangles: Int[np.ndarray, "triangles 3"]
    uv_triangles: Int[np.ndarray, "triangles 3"]


def make_part(faces: Faces, chosen: Bool[np.ndarray, "triangles"], mapped: bool) -> MeshPart | None:
    """Make a part of the chosen triangles that have texture coordinates, or of those without.

    Vertices keep their order. Returns None if there is no such triangle.
    """
    chosen = chosen & ((faces.uv_triangles[:, 0] >= 0) == mapped)
    if not chosen.any():
        return None
    triangles = faces.triangles[chosen]
    if not mapped:
        used, place = np.unique(triangles, return_inverse=True)
        geometry = MeshGeometry(faces.vertices[used], place.reshape(-1, 3))
        return MeshPart(geometry, None, None, GREY)
    count = len(faces.coordinates)
    pairs, place = np.unique(triangles * count + faces.uv_triangles[chosen], return_inverse=True)
    geometry = MeshGeometry(faces.vertices[pairs // count], place.reshape(-1, 3))
    return MeshPart(geometry, faces.coordinates[pairs % count], None, GREY)


def make_bare_parts(faces: Faces) -> list[MeshPart]:
    """Make parts of the triangles with and without texture coordinates."""
    every = np.ones(len(faces.triangles), bool)
    parts = [make_part(faces, every, mapped) for mapped in (True, False)]
    return [part for part in parts if part is not None]
