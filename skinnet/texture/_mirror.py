"""Mirror symmetry of a face: pairs of vertices that are mirror images of each other."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

TOLERANCE = 1e-3
"""Largest distance of a vertex from its mirror image, as a share of the largest extent."""


def find_mirror_vertices(
    vertices: Float[np.ndarray, "vertices 3"], tolerance: float = TOLERANCE
) -> Int[np.ndarray, "vertices"] | None:
    """Find the mirror image of each vertex under x -> -x.

    Args:
        vertices: Vertices of a face whose plane of symmetry is x = 0.
        tolerance: Largest distance between a mirrored vertex and its image, as a share of the
            largest extent.

    Returns:
        The index of each vertex's image, which is the vertex itself in the plane of symmetry; None
        if the mesh is not symmetric.

    Example:
        >>> import numpy as np
        >>> from skinnet.texture._mirror import find_mirror_vertices
        >>> find_mirror_vertices(np.array([[-1.0, 0, 0], [0, 2, 0], [1, 0, 0]]))
        array([2, 1, 0])
    """
    limit = tolerance * np.ptp(vertices, 0).max()
    found = cKDTree(vertices).query(vertices * [-1, 1, 1])
    distance, partner = (np.asarray(part) for part in found)
    if distance.max() > limit or (partner[partner] != np.arange(len(vertices))).any():
        return None
    return partner.astype(np.int64)
