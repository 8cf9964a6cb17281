"""Vertices that files repeat along the seams of a texture, made one again."""

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._mesh_parts import MeshGeometry
from skinnet.mesh._topology import weld

Points = Float[np.ndarray, "points 2"]
Numbers = Int[np.ndarray, "vertices"]
Triangles = Int[np.ndarray, "triangles 3"]


def merge_vertices(corners: MeshGeometry, listed: Float[np.ndarray, "listed 3"]) -> MeshGeometry:
    """One vertex for each position that a triangle has, in the order of `listed`, then as before.

    `listed` may be empty.
    """
    every = np.concatenate([listed, corners.vertices])
    used, place = np.unique(weld(every)[corners.triangles + len(listed)], return_inverse=True)
    return MeshGeometry(every[used], place.reshape(-1, 3))


def match_positions(
    listed: Float[np.ndarray, "listed 3"], vertices: Float[np.ndarray, "vertices 3"]
) -> Numbers:
    """For each vertex the first of `listed` at its position, if there is one."""
    index: Numbers = weld(np.concatenate([listed, vertices]))[len(listed) :]
    return index


def merge_coordinates(
    triangles: Triangles, uv: Points, uv_triangles: Triangles
) -> tuple[Float[np.ndarray, "shared 2"], Triangles]:
    """Texture coordinates one for each vertex, and more only where its triangles differ."""
    corner = uv_triangles.ravel()
    rows = np.column_stack([triangles.ravel(), uv[corner]])
    first, place = np.unique(weld(rows), return_inverse=True)
    return uv[corner[first]], place.reshape(-1, 3)
