"""Labelled pieces of a head, and how they are cut and put together."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, UInt8

from skinnet.mesh import compute_vertex_normals


class Part(NamedTuple):
    """Triangles in half heads, each with a label of `train.synthetic.labels`.

    x points to the face's left, y up, z ahead. `chart` is where a vertex lies on its own paint:
    azimuth and elevation on skin and hair, iris radii from the gaze on an eye, x and y elsewhere.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]
    label: UInt8[np.ndarray, "triangles"]
    chart: Float[np.ndarray, "vertices 2"]


def part(
    vertices: Float[np.ndarray, "vertices 3"],
    triangles: Int[np.ndarray, "triangles 3"],
    label: int,
    chart: Float[np.ndarray, "vertices 2"],
) -> Part:
    """A piece of one label, without the vertices that it does not use."""
    used, compact = np.unique(triangles, return_inverse=True)
    labels = np.full(len(triangles), label, np.uint8)
    return Part(vertices[used], compact.reshape(-1, 3), labels, chart[used])


def joined(parts: Sequence[Part]) -> Part:
    """All pieces as one; their vertices stay apart, so that each keeps its own chart."""
    first = np.cumsum([0, *(len(one.vertices) for one in parts[:-1])])
    triangles = [one.triangles + start for one, start in zip(parts, first, strict=True)]
    return Part(
        np.concatenate([one.vertices for one in parts]),
        np.concatenate(triangles),
        np.concatenate([one.label for one in parts]),
        np.concatenate([one.chart for one in parts]),
    )


def mirrored(whole: Part) -> Part:
    """The mirror image under x -> -x, its triangles still counter-clockwise from outside."""
    flip = np.array([-1.0, 1.0])
    return Part(
        whole.vertices * [-1, 1, 1],
        np.ascontiguousarray(whole.triangles[:, ::-1]),
        whole.label,
        whole.chart * flip,
    )


def sheet(rows: int, columns: int) -> Int[np.ndarray, "triangles 3"]:
    """Triangles of a grid of vertices row by row, seen from the front if rows go down and columns
    to the right."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    right, down = corner + 1, corner + columns
    upper = np.stack([corner, down, right], 1)
    return np.concatenate([upper, np.stack([right, down, down + 1], 1)])


def clipped(whole: Part, value: Float[np.ndarray, "vertices"], label: int | None = None) -> Part:
    """What lies where `value` on the vertices is positive, cut along its zero."""
    columns = np.column_stack([whole.vertices, whole.chart])
    columns, triangles, source = clip(columns, whole.triangles, value)
    labels = whole.label[source] if label is None else np.full(len(source), label, np.uint8)
    used, compact = np.unique(triangles, return_inverse=True)
    return Part(columns[used, :3], compact.reshape(-1, 3), labels, columns[used, 3:])


def clip(
    columns: Float[np.ndarray, "vertices k"],
    triangles: Int[np.ndarray, "triangles 3"],
    value: Float[np.ndarray, "vertices"],
) -> tuple[Float[np.ndarray, "more k"], Int[np.ndarray, "pieces 3"], Int[np.ndarray, "pieces"]]:
    """Triangles where `value` is positive, with new vertices on its zero, and whence each came."""
    inside = (value > 0)[triangles]
    count = inside.sum(1)
    lone, pair = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    a, b, c = _first(triangles[lone], inside[lone]).T
    p, q, r = _first(triangles[pair], ~inside[pair]).T
    edges = np.concatenate([np.stack(ends, 1) for ends in ((a, b), (a, c), (p, q), (p, r))])
    # One vertex an edge, whichever of its triangles asks.
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


def _first(triangles: Int[np.ndarray, "some 3"], marked: np.ndarray) -> Int[np.ndarray, "some 3"]:
    turn = (marked.argmax(1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(triangles, turn, 1)


def only(whole: Part, label: int) -> Part:
    """The triangles of one label."""
    return part(whole.vertices, whole.triangles[whole.label == label], label, whole.chart)


def normals(whole: Part) -> Float[np.ndarray, "vertices 3"]:
    return compute_vertex_normals(whole.vertices, whole.triangles)


def at(skin: Part, azimuth: float, elevation: float) -> Float[np.ndarray, "3"]:
    """The vertex whose place on the chart is nearest."""
    off = skin.chart - [azimuth, elevation]
    return skin.vertices[(off**2).sum(1).argmin()]
