"""Which vertices of a symmetric face are mirror images of each other."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from skinnet.mesh._topology import boundary, edge_keys, half_edges

TOLERANCE = 1e-3
"""How far from its mirror image a vertex may lie, as a share of the largest extent."""


def find_mirror_vertices(
    vertices: Float[np.ndarray, "vertices 3"], tolerance: float = TOLERANCE
) -> Int[np.ndarray, "vertices"] | None:
    """The mirror image of each vertex under x -> -x, or None if the mesh has no such symmetry.

    Every vertex must have a partner within `tolerance` times the largest extent and be its
    partner's partner; vertices in the plane x = 0 are their own.
    """
    limit = tolerance * np.ptp(vertices, 0).max()
    found = cKDTree(vertices).query(vertices * [-1, 1, 1])
    distance, partner = (np.asarray(part) for part in found)
    if distance.max() > limit or (partner[partner] != np.arange(len(vertices))).any():
        return None
    return partner.astype(np.int64)


def with_mirror_images(
    triangles: Int[np.ndarray, "triangles 3"], mirror: Int[np.ndarray, "vertices"]
) -> Int[np.ndarray, "more 3"]:
    """Triangles followed by those mirror images that are missing in a notch of the boundary.

    A model cut out of a head of quads by its vertices keeps half a quad on one side and not on the
    other. Only images that fit between two edges of the boundary are added.
    """
    count = len(mirror)
    while True:
        edges = half_edges(triangles)
        open_ = boundary(triangles)
        keys = edge_keys(edges, count, directed=True)
        rim = keys[open_.ravel()]
        lone = open_ & ~np.isin(edge_keys(mirror[edges[:, ::-1]], count, True), rim).reshape(-1, 3)
        images = mirror[triangles[lone.any(1)]][:, ::-1]
        sides = half_edges(images)
        new = ~np.isin(edge_keys(sides, count, True), keys).reshape(-1, 3).any(1)
        joined = np.isin(edge_keys(sides[:, ::-1], count, True), rim).reshape(-1, 3).sum(1) == 2
        if not (new & joined).any():
            return triangles
        triangles = np.concatenate([triangles, images[new & joined]])
