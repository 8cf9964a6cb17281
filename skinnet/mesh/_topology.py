"""How the triangles of a mesh hang together: edges, boundaries, components, doubled vertices."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from skinnet.errors import InputError

Triangles = Int[np.ndarray, "triangles 3"]


def half_edges(triangles: Triangles) -> Int[np.ndarray, "halves 2"]:
    """The directed edges of every triangle [3 T, 2]: row 3 i + k starts at corner k of i."""
    return np.stack([triangles, np.roll(triangles, -1, 1)], -1).reshape(-1, 2)


def edge_keys(
    edges: Int[np.ndarray, "edges 2"], vertex_count: int, directed: bool = False
) -> Int[np.ndarray, "edges"]:
    """One number for each edge, the same for both directions unless `directed`."""
    ends = edges if directed else np.sort(edges, 1)
    return np.asarray(ends[:, 0].astype(np.int64) * vertex_count + ends[:, 1])


def boundary(triangles: Triangles) -> Bool[np.ndarray, "triangles 3"]:
    """Whether edge k of each triangle, from corner k to corner k + 1, belongs to it alone."""
    keys = edge_keys(half_edges(triangles), int(triangles.max(initial=-1)) + 1)
    _, place, count = np.unique(keys, return_inverse=True, return_counts=True)
    return np.asarray(count[place] == 1).reshape(-1, 3)


def boundary_loops(triangles: Triangles) -> list[Int[np.ndarray, "loop"]]:
    """Vertices of each closed boundary, in the direction of the triangles' edges.

    Raises `InputError` where triangles overlap or meet in a way that no surface does: an edge of
    three triangles or of two that are turned against each other, a vertex where two boundaries
    touch.
    """
    edges = half_edges(triangles)
    _check_manifold(edges)
    start, end = edges[boundary(triangles).ravel()].T
    if len(np.unique(start)) < len(start):
        touching = np.flatnonzero(np.bincount(start) > 1)
        raise InputError(
            f"Two boundaries of the mesh touch in vertex {touching[0]}; remove the triangles that "
            "hang on by a single vertex."
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


def label_components(triangles: Triangles, vertex_count: int) -> Int[np.ndarray, "vertices"]:
    """A number for each vertex, the same for those that triangles connect."""
    start, end = half_edges(triangles).T
    links = coo_array((np.ones(len(start), bool), (start, end)), (vertex_count, vertex_count))
    return np.asarray(connected_components(links, directed=False)[1])


def weld(vertices: Float[np.ndarray, "vertices 3"]) -> Int[np.ndarray, "vertices"]:
    """For each vertex the first one at exactly the same position, itself if there is none."""
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
    keys, times = np.unique(edge_keys(edges, count, directed=True), return_counts=True)
    if (times > 1).any():
        a, b = divmod(int(keys[times > 1][0]), count)
        raise InputError(
            f"The edge of vertices {a} and {b} belongs to more than two triangles, or to two of "
            "opposite orientation; repair the mesh first."
        )
