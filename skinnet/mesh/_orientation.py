"""Which way the faces of a mesh look."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from skinnet.mesh._topology import edge_keys, half_edges

Vertices = Float[np.ndarray, "vertices 3"]
Triangles = Int[np.ndarray, "triangles 3"]
Labels = Int[np.ndarray, "triangles"]
Lengths = Float[np.ndarray, "triangles"]
Choice = Bool[np.ndarray, "triangles"]


class AdjacentFaces(NamedTuple):
    """Pairs of triangles with a common edge, and whether both run through it the same way."""

    first: Int[np.ndarray, "pairs"]
    second: Int[np.ndarray, "pairs"]
    same: Bool[np.ndarray, "pairs"]


def pair_adjacent_faces(triangles: Triangles) -> AdjacentFaces:
    """Pairs of triangles with a common edge, of at most two at each."""
    edges = half_edges(triangles)
    keys = edge_keys(edges, int(triangles.max()) + 1)
    order = np.argsort(keys, kind="stable")
    pair = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    one, two = order[pair], order[pair + 1]
    return AdjacentFaces(one // 3, two // 3, edges[one, 0] == edges[two, 0])


def label_face_components(triangles: Triangles) -> Labels:
    """A number for each triangle, the same for those that edges connect."""
    first, second, _ = pair_adjacent_faces(triangles)
    ties = coo_array((np.ones(len(first), bool), (first, second)), (len(triangles),) * 2)
    label: Labels = connected_components(ties, directed=False)[1]
    return label


def area_vectors(vertices: Vertices, triangles: Triangles) -> Float[np.ndarray, "triangles 3"]:
    """Normals as long as the triangles' areas."""
    a, b, c = np.moveaxis(vertices[triangles].astype(np.float64), 1, 0)
    return np.cross(b - a, c - a) / 2


def areas(vertices: Vertices, triangles: Triangles) -> Lengths:
    """Areas of triangles."""
    lengths: Lengths = np.linalg.norm(area_vectors(vertices, triangles), axis=1)
    return lengths


def flip_triangles(triangles: Triangles, turn: Choice) -> Triangles:
    """Triangles, those of `turn` seen from the other side."""
    return np.where(turn[:, None], triangles[:, [0, 2, 1]], triangles)


def find_inconsistent_faces(vertices: Vertices, triangles: Triangles) -> Choice:
    """Triangles to turn so that neighbours run through their edge in opposite directions.

    Every triangle stands twice in a graph, as it is and turned, and each is tied to the neighbours
    that agree with it. A component that can be oriented then falls into two, of which the one with
    the larger area of triangles as they are stays; of one that cannot, nothing is turned.
    """
    count = len(triangles)
    first, second, same = pair_adjacent_faces(triangles)
    ends = np.where(same, second + count, second), np.where(same, second, second + count)
    rows, columns = np.concatenate([first, first + count]), np.concatenate(ends)
    ties = coo_array((np.ones(len(rows), bool), (rows, columns)), (2 * count, 2 * count))
    label = connected_components(ties, directed=False)[1]
    as_is, other = label[:count], label[count:]
    weight = np.bincount(as_is, areas(vertices, triangles), label.max() + 1)
    tie = weight[other] == weight[as_is]
    turn: Choice = (weight[other] > weight[as_is]) | tie & (other < as_is)
    return turn


def is_inside_out(vertices: Vertices, triangles: Triangles) -> bool:
    """Whether normals point to the middle on the whole: of a closed surface, a dome, or a mask."""
    vectors = area_vectors(vertices, triangles)
    centres = vertices[triangles].mean(1)
    middle = np.average(centres, 0, np.linalg.norm(vectors, axis=1))
    return float((vectors * (centres - middle)).sum()) < 0
