"""Directions that a surface faces."""

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._topology import weld


def compute_vertex_normals(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> Float[np.ndarray, "vertices 3"]:
    """Unit normals of the vertices, each triangle around one weighted by its area.

    Vertices at one position count as one, so that a seam does not show. Zero where no triangle is.
    """
    first = weld(vertices)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area, corners = np.cross(b - a, c - a), first[triangles].ravel()
    summed = [np.bincount(corners, np.repeat(part, 3), len(vertices)) for part in area.T]
    return normalise(np.stack(summed, 1)[first])


def normalise(vectors: Float[np.ndarray, "*shape 3"]) -> Float[np.ndarray, "*shape 3"]:
    """Vectors of length one in the same directions; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1)
