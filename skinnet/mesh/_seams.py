"""Merging of the vertices and texture coordinates that files repeat at seams."""

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._mesh_parts import MeshGeometry
from skinnet.mesh._topology import weld

_Triangles = Int[np.ndarray, "triangles 3"]


def merge_vertices(geometry: MeshGeometry, listed: Float[np.ndarray, "listed 3"]) -> MeshGeometry:
    """Merge vertices at the same position and drop those without a triangle.

    The order is that of `listed` (which may be empty), then that of the geometry.
    """
    every = np.concatenate([listed, geometry.vertices])
    used, place = np.unique(weld(every)[geometry.triangles + len(listed)], return_inverse=True)
    return MeshGeometry(every[used], place.reshape(-1, 3))


def match_positions(
    listed: Float[np.ndarray, "listed 3"], vertices: Float[np.ndarray, "vertices 3"]
) -> Int[np.ndarray, "vertices"]:
    """Find the first of `listed` at the position of each vertex.

    If there is none, the index is `len(listed)` or more.
    """
    return np.asarray(weld(np.concatenate([listed, vertices]))[len(listed) :])


def merge_coordinates(
    triangles: _Triangles, uv: Float[np.ndarray, "points 2"], uv_triangles: _Triangles
) -> tuple[Float[np.ndarray, "merged 2"], _Triangles]:
    """Merge equal texture coordinates of the same vertex."""
    corner = uv_triangles.ravel()
    rows = np.column_stack([triangles.ravel(), uv[corner]])
    first, place = np.unique(weld(rows), return_inverse=True)
    return uv[corner[first]], place.reshape(-1, 3)
