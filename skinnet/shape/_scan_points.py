"""A scan as dense points with normals, for nearest-neighbour search."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree
from trimesh.remesh import subdivide

from skinnet.errors import InputError
from skinnet.mesh._normals import compute_vertex_normals
from skinnet.mesh._topology import find_boundary_edges, list_half_edges
from skinnet.mesh.mesh import Mesh

MIN_POINTS = 60_000
"""Triangles of a coarser scan are split into four until it has this many points."""

SPIKE_RATIO = 4.0
"""A vertex is an outlier of the scanner if its shortest edge is this many times as long as the
mean of its neighbours' shortest edges."""


class NearestPoints(NamedTuple):
    """The nearest point of a scan to each query."""

    distance: Float[np.ndarray, "queries"]
    point: Float[np.ndarray, "queries 3"]
    normal: Float[np.ndarray, "queries 3"]
    on_boundary: Bool[np.ndarray, "queries"]

    def measure_distance(
        self, queries: Float[np.ndarray, "queries 3"]
    ) -> Float[np.ndarray, "queries"]:
        """Measure the distance to the tangent plane, or on the boundary to the point."""
        plane = np.abs(np.einsum("qk,qk->q", queries - self.point, self.normal))
        return np.where(self.on_boundary, self.distance, plane)


class ScanPoints:
    """Points of a mesh with unit normals, and whether each lies on the boundary.

    Spikes (`SPIKE_RATIO`) are removed first. The nearest point is a vertex, not a point inside a
    triangle; triangles are subdivided so that vertices are close to each other.
    """

    def __init__(self, mesh: Mesh) -> None:
        vertices, triangles = mesh.vertices.astype(np.float64), mesh.triangles
        triangles = triangles[~find_spikes(vertices, triangles)[triangles].any(1)]
        if not len(triangles):
            raise InputError(f"{mesh.name} has no surface, only single points far apart.")
        while len(vertices) < MIN_POINTS:
            vertices, triangles = subdivide(vertices, triangles)
        used = np.unique(triangles)
        self.points = vertices[used]
        self.normals = compute_vertex_normals(vertices, triangles)[used]
        self.tree = cKDTree(self.points)
        edge = np.zeros(len(vertices), bool)
        edge[list_half_edges(triangles)[find_boundary_edges(triangles).ravel()].ravel()] = True
        self.on_boundary = edge[used]

    def find_nearest(self, queries: Float[np.ndarray, "queries 3"]) -> NearestPoints:
        """Find the nearest points, on all processors."""
        distance, index = self.tree.query(queries, workers=-1)
        distance = np.asarray(distance)
        return NearestPoints(
            distance, self.points[index], self.normals[index], self.on_boundary[index]
        )


def find_spikes(
    vertices: Float[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> Bool[np.ndarray, "vertices"]:
    """Find vertices whose edges are all far longer than their neighbours' (`SPIKE_RATIO`)."""
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    both = np.concatenate([sides, sides[:, ::-1]])
    length = np.linalg.norm(vertices[both[:, 0]] - vertices[both[:, 1]], axis=1)
    shortest = np.full(len(vertices), np.inf)
    np.minimum.at(shortest, both[:, 0], length)
    count = np.bincount(both[:, 0], minlength=len(vertices))
    total = np.bincount(both[:, 0], shortest[both[:, 1]], len(vertices))
    return shortest > SPIKE_RATIO * (total / np.maximum(count, 1))
