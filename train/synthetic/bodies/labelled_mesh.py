"""Labelled meshes: pieces of a head, and how they are cut and joined."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from skinnet.mesh._normals import compute_vertex_normals


class LabelledMesh(NamedTuple):
    """Triangles with a label each; lengths are in half heads.

    x points to the face's left, y up, z ahead. `label` is one of `train.synthetic.labels`. `chart`
    is the place of a vertex on its label's chart: azimuth and elevation on skin and hair, iris
    radii from the gaze on an eye, x and y elsewhere.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]
    label: UInt8[np.ndarray, "triangles"]
    chart: Float[np.ndarray, "vertices 2"]


def label_mesh(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    label: int,
    chart: Float[np.ndarray, "vertices 2"],
) -> LabelledMesh:
    """Give all triangles one label, and drop the vertices that they do not use."""
    used, compact = np.unique(triangles, return_inverse=True)
    labels = np.full(len(triangles), label, np.uint8)
    return LabelledMesh(vertices[used], compact.reshape(-1, 3), labels, chart[used])


def join(meshes: Sequence[LabelledMesh]) -> LabelledMesh:
    """Join meshes; their vertices stay apart, so that each keeps its own chart."""
    first = np.cumsum([0, *(len(one.vertices) for one in meshes[:-1])])
    triangles = [one.triangles + start for one, start in zip(meshes, first, strict=True)]
    return LabelledMesh(
        np.concatenate([one.vertices for one in meshes]),
        np.concatenate(triangles),
        np.concatenate([one.label for one in meshes]),
        np.concatenate([one.chart for one in meshes]),
    )


def mirror(mesh: LabelledMesh) -> LabelledMesh:
    """Mirror x; the triangles stay counter-clockwise from outside."""
    flip = np.array([-1.0, 1.0])
    return LabelledMesh(
        mesh.vertices * [-1, 1, 1],
        np.ascontiguousarray(mesh.triangles[:, ::-1]),
        mesh.label,
        mesh.chart * flip,
    )


def triangulate_grid(rows: int, columns: int) -> Int[np.ndarray, "triangles 3"]:
    """Make the triangles of a grid of vertices, row by row.

    Args:
        rows: Rows of vertices; they go down.
        columns: Columns of vertices; they go to the right.

    Returns:
        Triangles, counter-clockwise from the front.

    Example:
        >>> triangulate_grid(2, 2)
        array([[0, 2, 1],
               [1, 2, 3]])
    """
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    right, down = corner + 1, corner + columns
    upper = np.stack([corner, down, right], 1)
    return np.concatenate([upper, np.stack([right, down, down + 1], 1)])


def clip(
    mesh: LabelledMesh, value: Float[np.ndarray, "vertices"], label: int | None = None
) -> LabelledMesh:
    """Cut a mesh along the zero of a value, and keep the part where it is positive.

    Args:
        mesh: What is cut.
        value: One number for each vertex, interpolated in between.
        label: The label of the part; None keeps the labels.

    Returns:
        The part, with new vertices along the cut.
    """
    columns = np.column_stack([mesh.vertices, mesh.chart])
    columns, triangles, source = clip_triangles(columns, mesh.triangles, value)
    labels = mesh.label[source] if label is None else np.full(len(source), label, np.uint8)
    used, compact = np.unique(triangles, return_inverse=True)
    return LabelledMesh(columns[used, :3], compact.reshape(-1, 3), labels, columns[used, 3:])


def clip_triangles(
    columns: Float[np.ndarray, "vertices k"],
    triangles: Int[np.ndarray, "triangles 3"],
    value: Float[np.ndarray, "vertices"],
) -> tuple[Float[np.ndarray, "more k"], Int[np.ndarray, "pieces 3"], Int[np.ndarray, "pieces"]]:
    """Cut triangles along the zero of a value, and keep what is positive.

    Args:
        columns: Numbers of each vertex, which are interpolated along the cut.
        triangles: Indices of vertices.
        value: One number for each vertex.

    Returns:
        The columns with those of new vertices behind them, the triangles that are left, and the
        triangle that each of them comes from.
    """
    inside = (value > 0)[triangles]
    count = inside.sum(1)
    lone, pair = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    a, b, c = _rotate_to_marked(triangles[lone], inside[lone]).T
    p, q, r = _rotate_to_marked(triangles[pair], ~inside[pair]).T
    edges = np.concatenate([np.stack(ends, 1) for ends in ((a, b), (a, c), (p, q), (p, r))])
    # One new vertex an edge, which both of its triangles share.
    edges, place = np.unique(np.sort(edges, 1), axis=0, return_inverse=True)
    cuts = np.split(place.ravel() + len(columns), np.cumsum([len(a), len(a), len(p)]))
    ab, ac, pq, pr = cuts
    low, high = value[edges].T
    share = (low / np.where(low == high, 1, low - high))[:, None]
    new = columns[edges[:, 0]] * (1 - share) + columns[edges[:, 1]] * share
    pieces = [triangles[count == 3]]
    pieces += [np.stack(one, 1) for one in ((a, ab, ac), (pq, q, r), (pq, r, pr))]
    source = np.concatenate([np.flatnonzero(count == 3), lone, pair, pair])
    return np.concatenate([columns, new]), np.concatenate(pieces), source


def _rotate_to_marked(
    triangles: Int[np.ndarray, "some 3"], marked: Bool[np.ndarray, "some 3"]
) -> Int[np.ndarray, "some 3"]:
    order = (marked.argmax(1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(triangles, order, 1)


def select(mesh: LabelledMesh, label: int) -> LabelledMesh:
    """Select the triangles of one label."""
    return label_mesh(mesh.vertices, mesh.triangles[mesh.label == label], label, mesh.chart)


def compute_normals(mesh: LabelledMesh) -> Float[np.ndarray, "vertices 3"]:
    """Compute unit normals of the vertices."""
    return compute_vertex_normals(mesh.vertices, mesh.triangles)


def find_vertex(skin: LabelledMesh, azimuth: float, elevation: float) -> Float[np.ndarray, "3"]:
    """Find the vertex whose place on the chart is nearest; angles are in radians."""
    off = skin.chart - [azimuth, elevation]
    return np.asarray(skin.vertices[(off**2).sum(1).argmin()])
