"""A scan as points close together, with normals, for nearest-point search."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree
from trimesh.remesh import subdivide

from skinnet.errors import InputError
from skinnet.mesh._topology import boundary, half_edges
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.normals import compute_vertex_normals

DENSE = 60_000
"""A coarser scan is subdivided, all triangles into four, until it has this many points."""

SPIKE = 4.0
"""A vertex that is this many times as far from its nearest neighbour as its neighbours are from
theirs is an outlier of the scanner."""


class Nearest(NamedTuple):
    """The nearest point of the surface to each query."""

    distance: Float[np.ndarray, "queries"]
    point: Float[np.ndarray, "queries 3"]
    normal: Float[np.ndarray, "queries 3"]
    boundary: Bool[np.ndarray, "queries"]

    def across(self, queries: Float[np.ndarray, "queries 3"]) -> Float[np.ndarray, "queries"]:
        """Distance to the surface: to the tangent plane, or at an open edge to the point."""
        plane = np.abs(np.einsum("qk,qk->q", queries - self.point, self.normal))
        return np.where(self.boundary, self.distance, plane)


class ScanPoints:
    """Points on a mesh with unit normals, and which of them lie on its open edge.

    Spikes (`SPIKE`) are cut off first. Distances are to the points, which stand close: the
    subdivision bounds their spacing, and the fit measures across the tangent plane.
    """

    def __init__(self, mesh: Mesh):
        vertices, triangles = mesh.vertices.astype(np.float64), mesh.triangles
        triangles = triangles[~spikes(vertices, triangles)[triangles].any(1)]
        if not len(triangles):
            raise InputError(f"{mesh.name} has no surface, only single points far apart.")
        while len(vertices) < DENSE:
            vertices, triangles = subdivide(vertices, triangles)
        used = np.unique(triangles)
        self.points = vertices[used]
        self.normals = compute_vertex_normals(vertices, triangles)[used]
        self.tree = cKDTree(self.points)
        edge = np.zeros(len(vertices), bool)
        edge[half_edges(triangles)[boundary(triangles).ravel()].ravel()] = True
        self.boundary = edge[used]

    def nearest(self, queries: Float[np.ndarray, "queries 3"]) -> Nearest:
        """By distance between points, on all processors."""
        distance, index = self.tree.query(queries, workers=-1)
        distance = np.asarray(distance)
        return Nearest(distance, self.points[index], self.normals[index], self.boundary[index])


def spikes(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> Bool[np.ndarray, "vertices"]:
    """Vertices that stand away from all their neighbours, as `SPIKE` has it."""
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    both = np.concatenate([sides, sides[:, ::-1]])
    length = np.linalg.norm(vertices[both[:, 0]] - vertices[both[:, 1]], axis=1)
    nearest = np.full(len(vertices), np.inf)
    np.minimum.at(nearest, both[:, 0], length)
    count = np.bincount(both[:, 0], minlength=len(vertices))
    around = np.bincount(both[:, 0], nearest[both[:, 1]], len(vertices)) / np.maximum(count, 1)
    return nearest > SPIKE * around
