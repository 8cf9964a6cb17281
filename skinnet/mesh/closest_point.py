"""The closest point of a surface, exactly, for many queries at once."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

LEAF = 4
"""Triangles in a box of the finest level."""

CHUNK = 100_000
"""Queries that go through the tree together; it bounds the memory."""


class ClosestPoints(NamedTuple):
    """Where the surface is closest: `triangle` -1 and `distance` inf if beyond the limit."""

    distance: Float[np.ndarray, "queries"]
    triangle: Int[np.ndarray, "queries"]
    barycentric: Float[np.ndarray, "queries 3"]


class TriangleTree:
    """A tree of boxes over triangles of any size.

    Every level halves the triangles of a box along its longest side. All queries go down
    together, each into those boxes that are nearer than the best it has, at first its nearest
    vertex.
    """

    def __init__(
        self,
        vertices: Float[np.ndarray, "vertices 3"],
        triangles: Int[np.ndarray, "triangles 3"],
    ):
        corners = vertices[triangles].astype(np.float64)
        self.nearest_vertex = cKDTree(vertices[np.unique(triangles)])
        self.order, self.depth = _order(corners.mean(1))
        corners = corners[self.order]
        self.low, self.high = _boxes(corners, self.depth)
        self.start = corners[:, 0]
        self.sides = corners[:, 1:] - corners[:, :1]
        self.gram = np.einsum("tix,tjx->tij", self.sides, self.sides)

    def query(self, points: Float[np.ndarray, "queries 3"], limit: float = np.inf) -> ClosestPoints:
        """The closest point to each of `points` within `limit`."""
        parts = [
            self._query(points[i : i + CHUNK], limit) for i in range(0, max(len(points), 1), CHUNK)
        ]
        return ClosestPoints(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _query(self, points: Float[np.ndarray, "queries 3"], limit: float) -> ClosestPoints:
        bound = np.minimum(self.nearest_vertex.query(points)[0], limit)
        # Rounding must not put the box of the nearest vertex out of reach.
        reach = (bound * (1 + 1e-9)) ** 2 + 1e-300
        query, box = np.arange(len(points)), np.zeros(len(points), np.int64)
        for level in range(self.depth):
            query, box = np.repeat(query, 2), np.repeat(2 * box, 2)
            box[1::2] += 1
            place = points[query]
            low, high = self.low[level][box], self.high[level][box]
            gap = np.maximum(np.maximum(low - place, place - high), 0)
            near = np.einsum("px,px->p", gap, gap) <= reach[query]
            query, box = query[near], box[near]
        return self._best(points, np.repeat(query, LEAF), _members(box), limit)

    def _best(
        self,
        points: Float[np.ndarray, "queries 3"],
        query: Int[np.ndarray, "pairs"],
        triangle: Int[np.ndarray, "pairs"],
        limit: float,
    ) -> ClosestPoints:
        """The nearest of the pairs of each query, which come in the order of the queries."""
        away = points[query] - self.start[triangle]
        along = np.einsum("pix,px->pi", self.sides[triangle], away)
        second, third, less = _nearest_in_triangle(self.gram[triangle], along)
        squared = np.einsum("px,px->p", away, away) - less
        found, first = np.unique(query, return_index=True)
        best = np.full(len(points), np.inf)
        if len(found):
            best[found] = np.minimum.reduceat(squared, first)
        winners = np.flatnonzero(squared == best[query])
        found, first = np.unique(query[winners], return_index=True)
        winners = winners[first]
        return self._result(
            points, found, triangle[winners], second[winners], third[winners], limit
        )

    def _result(
        self,
        points: Float[np.ndarray, "queries 3"],
        found: Int[np.ndarray, "found"],
        triangle: Int[np.ndarray, "found"],
        second: Float[np.ndarray, "found"],
        third: Float[np.ndarray, "found"],
        limit: float,
    ) -> ClosestPoints:
        side_b, side_c = self.sides[triangle, 0], self.sides[triangle, 1]
        place = self.start[triangle] + second[:, None] * side_b + third[:, None] * side_c
        away = np.linalg.norm(points[found] - place, axis=1)
        within = away <= limit
        found = found[within]
        distance = np.full(len(points), np.inf)
        number = np.full(len(points), -1)
        barycentric = np.zeros((len(points), 3))
        distance[found] = away[within]
        number[found] = self.order[triangle[within]]
        second, third = second[within], third[within]
        barycentric[found] = np.stack([(1 - second - third).clip(0), second, third], 1)
        return ClosestPoints(distance, number, barycentric)


def _order(middles: Float[np.ndarray, "triangles 3"]) -> tuple[Int[np.ndarray, "slots"], int]:
    """Triangles so that every box of every level holds a run of them, and the number of levels.

    The last boxes are filled with a triangle repeated.
    """
    depth = int(np.ceil(np.log2(max(len(middles) / LEAF, 1))))
    slots = LEAF << depth
    order = np.minimum(np.arange(slots), len(middles) - 1)
    for level in range(depth):
        runs = middles[order].reshape(1 << level, -1, 3)
        longest = np.ptp(runs, axis=1).argmax(1)
        key = np.take_along_axis(runs, longest[:, None, None], 2)[..., 0]
        within = np.argsort(key, axis=1, kind="stable")
        order = np.take_along_axis(order.reshape(1 << level, -1), within, 1).ravel()
    return order, depth


def _boxes(
    corners: Float[np.ndarray, "slots 3 3"], depth: int
) -> tuple[list[Float[np.ndarray, "_ 3"]], list[Float[np.ndarray, "_ 3"]]]:
    """Lowest and highest corner of the 2, 4, 8, ... boxes of each level."""
    low = [corners.min(1).reshape(-1, LEAF, 3).min(1)]
    high = [corners.max(1).reshape(-1, LEAF, 3).max(1)]
    for _ in range(depth - 1):
        low.append(low[-1].reshape(-1, 2, 3).min(1))
        high.append(high[-1].reshape(-1, 2, 3).max(1))
    return low[::-1], high[::-1]


def _members(box: Int[np.ndarray, "boxes"]) -> Int[np.ndarray, "members"]:
    return (LEAF * box[:, None] + np.arange(LEAF)).ravel()


def _nearest_in_triangle(
    gram: Float[np.ndarray, "pairs 2 2"], along: Float[np.ndarray, "pairs 2"]
) -> tuple[Float[np.ndarray, "pairs"], Float[np.ndarray, "pairs"], Float[np.ndarray, "pairs"]]:
    """Coordinates (s, t) of the point of a + s ab + t ac nearest to p, 0 <= s, t, s + t <= 1.

    From the products of the sides with each other and with p - a; third is |p - a|^2 less the
    squared distance. Inside if the plane's nearest point is, else the best on the three edges.
    """
    bb, bc, cc = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 1]
    pb, pc = along.T
    tiny = 1e-300
    determinant = bb * cc - bc * bc
    plane = np.maximum(determinant, tiny)
    s, t = (cc * pb - bc * pc) / plane, (bb * pc - bc * pb) / plane
    zero = np.zeros_like(s)
    on_b = (pb / np.maximum(bb, tiny)).clip(0, 1)
    on_c = (pc / np.maximum(cc, tiny)).clip(0, 1)
    across = ((pc - pb + bb - bc) / np.maximum(bb + cc - 2 * bc, tiny)).clip(0, 1)
    inside = (determinant > 1e-14 * bb * cc) & (s >= 0) & (t >= 0) & (s + t <= 1)
    best_s, best_t = np.where(inside, s, on_b), np.where(inside, t, zero)
    best = _less(best_s, best_t, bb, bc, cc, pb, pc)
    for s, t in ((zero, on_c), (1 - across, across)):
        less = _less(s, t, bb, bc, cc, pb, pc)
        better = ~inside & (less > best)
        best_s, best_t = np.where(better, s, best_s), np.where(better, t, best_t)
        best = np.where(better, less, best)
    return best_s, best_t, best


def _less(
    s: Float[np.ndarray, "pairs"],
    t: Float[np.ndarray, "pairs"],
    bb: Float[np.ndarray, "pairs"],
    bc: Float[np.ndarray, "pairs"],
    cc: Float[np.ndarray, "pairs"],
    pb: Float[np.ndarray, "pairs"],
    pc: Float[np.ndarray, "pairs"],
) -> Float[np.ndarray, "pairs"]:
    """What the squared distance to the point (s, t) lacks to that to a."""
    return np.asarray(2 * (s * pb + t * pc) - s * s * bb - 2 * s * t * bc - t * t * cc)
