"""Normals of a triangle mesh at its vertices."""

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._topology import weld
from skinnet.mesh._vectors import normalise


def compute_vertex_normals(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> Float[np.ndarray, "vertices 3"]:
    """Compute the mean normal of the triangles around each vertex, weighted by their areas.

    Vertices at the same position share their triangles, so normals are continuous across a seam.

    Args:
        vertices: Positions in any unit.
        triangles: Vertex indices, counter-clockwise seen from outside.

    Returns:
        Unit normals; zero for a vertex that no triangle uses.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh._normals import compute_vertex_normals
        >>> compute_vertex_normals(np.eye(3), np.array([[0, 1, 2]])).round(3)
        array([[0.577, 0.577, 0.577],
               [0.577, 0.577, 0.577],
               [0.577, 0.577, 0.577]])
    """
    first = weld(vertices)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area, corners = np.cross(b - a, c - a), first[triangles].ravel()
    summed = [np.bincount(corners, np.repeat(part, 3), len(vertices)) for part in area.T]
    return normalise(np.stack(summed, 1)[first])
