"""Topology of a mesh: edges, boundaries, components, repeated vertices."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from skinnet.errors import InputError

_Triangles = Int[np.ndarray, "triangles 3"]


def list_half_edges(triangles: _Triangles) -> Int[np.ndarray, "halves 2"]:
    """List the directed edges of all triangles; row 3 i + k starts at corner k of triangle i."""
    return np.stack([triangles, np.roll(triangles, -1, 1)], -1).reshape(-1, 2)


def compute_edge_keys(
    edges: Int[np.ndarray, "edges 2"], vertex_count: int, directed: bool = False
) -> Int[np.ndarray, "edges"]:
    """Compute a number that identifies each edge, the same in both directions unless `directed`."""
    ends = edges if directed else np.sort(edges, 1)
    return np.asarray(ends[:, 0].astype(np.int64) * vertex_count + ends[:, 1])


def find_boundary_edges(triangles: _Triangles) -> Bool[np.ndarray, "triangles 3"]:
    """Tell whether edge k of each triangle, from corner k to k + 1, is in no other triangle."""
    keys = compute_edge_keys(list_half_edges(triangles), int(triangles.max(initial=-1)) + 1)
    _, place, count = np.unique(keys, return_inverse=True, return_counts=True)
    return np.asarray(count[place] == 1).reshape(-1, 3)


def list_boundary_loops(triangles: _Triangles) -> list[Int[np.ndarray, "loop"]]:
    """List the vertices of each boundary loop, in the direction of the triangles' edges.

    Raises:
        InputError: If the mesh is not an oriented manifold: an edge has three triangles or two of
            opposite orientation, or two boundaries touch in a vertex.
    """
    edges = list_half_edges(triangles)
    _check_manifold(edges)
    start, end = edges[find_boundary_edges(triangles).ravel()].T
    if len(np.unique(start)) < len(start):
        touching = np.flatnonzero(np.bincount(start) > 1)
        raise InputError(
            f"Two boundaries of the mesh touch in vertex {touching[0]}; remove the triangles that "
            "are connected by a single vertex."
        )
    following = dict(zip(start.tolist(), end.tolist(), strict=True))
    loops = []
    while following:
        first, vertex = following.popitem()
        loop = [first]
        while vertex != first:
            loop.append(vertex)
            vertex = following.pop(vertex)
        loops.append(np.array(loop))
    return loops


def label_components(triangles: _Triangles, vertex_count: int) -> Int[np.ndarray, "vertices"]:
    """Number each vertex by its component; triangles connect their vertices."""
    start, end = list_half_edges(triangles).T
    links = coo_array((np.ones(len(start), bool), (start, end)), (vertex_count, vertex_count))
    return np.asarray(connected_components(links, directed=False)[1])


def weld(vertices: Float[np.ndarray, "vertices 3"]) -> Int[np.ndarray, "vertices"]:
    """Find, for each vertex, the first one at exactly the same position, perhaps itself."""
    order = np.lexsort(vertices.T)
    sorted_ = vertices[order]
    new = np.r_[True, (sorted_[1:] != sorted_[:-1]).any(1)][: len(vertices)]
    # lexsort is stable, so the first of a run has the lowest number.
    first = order[new][np.cumsum(new) - 1]
    welded = np.empty(len(vertices), np.int64)
    welded[order] = first
    return welded


def _check_manifold(edges: Int[np.ndarray, "halves 2"]) -> None:
    count = int(edges.max(initial=-1)) + 1
    keys, times = np.unique(compute_edge_keys(edges, count, directed=True), return_counts=True)
    if (times > 1).any():
        a, b = divmod(int(keys[times > 1][0]), count)
        raise InputError(
            f"The edge of vertices {a} and {b} belongs to more than two triangles, or to two of "
            "opposite orientation; repair the mesh first."
        )
