"""Closest points of a triangle mesh, exact, for many queries at once."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

LEAF = 4
"""Triangles in a box of the finest level."""

CHUNK = 100_000
"""Queries that descend the tree together; this bounds the memory."""


class ClosestPoints(NamedTuple):
    """The closest point of a mesh to each query.

    Attributes:
        distance: In the mesh's unit; inf where nothing lies within the limit.
        triangle: Index of the triangle that contains the point, -1 where nothing lies within it.
        barycentric: Weights of that triangle's three corners, at least 0 and of sum 1.
    """

    distance: Float[np.ndarray, "queries"]
    triangle: Int[np.ndarray, "queries"]
    barycentric: Float[np.ndarray, "queries 3"]


class TriangleTree:
    """A tree of bounding boxes over triangles of any size, for exact closest points.

    Each level halves the triangles of a box along its longest side. All queries descend together,
    each into the boxes nearer than its current best, which is at first its nearest vertex.

    trimesh's `proximity.closest_point` also needs the package rtree. Its `triangles.closest_point`,
    applied to the 8 triangles with the nearest centroids, is 3 to 6 times as fast, but not exact:
    on a scan of a face it is wrong by up to 0.2 % of the scan's size (`benchmarks.texture` prints
    both times, and `closest_centroid_error`).

    Args:
        vertices: Positions in any unit.
        triangles: Vertex indices; triangles without an area count as the edge or point that they
            are.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import TriangleTree
        >>> tree = TriangleTree(np.eye(3), np.array([[0, 1, 2]]))
        >>> tree.query(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])).distance.round(3)
        array([0.577, 2.   ])
    """

    def __init__(
        self,
        vertices: Float[np.ndarray, "vertices 3"],
        triangles: Int[np.ndarray, "triangles 3"],
    ) -> None:
        corners = vertices[triangles].astype(np.float64)
        self.nearest_vertex = cKDTree(vertices[np.unique(triangles)])
        self.order, self.depth = _order_triangles(corners.mean(1))
        corners = corners[self.order]
        self.low, self.high = _bound_boxes(corners, self.depth)
        self.start = corners[:, 0]
        self.sides = corners[:, 1:] - corners[:, :1]
        self.gram = np.einsum("tix,tjx->tij", self.sides, self.sides)

    def query(self, points: Float[np.ndarray, "queries 3"], limit: float = np.inf) -> ClosestPoints:
        """Find the closest point of the mesh to each of `points`.

        Args:
            points: Queries, in the mesh's unit.
            limit: Largest distance at which a point counts.

        Returns:
            Distances, triangles and barycentric coordinates.
        """
        parts = [
            self._query(points[i : i + CHUNK], limit) for i in range(0, max(len(points), 1), CHUNK)
        ]
        return ClosestPoints(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    def _query(self, points: Float[np.ndarray, "queries 3"], limit: float) -> ClosestPoints:
        bound = np.minimum(self.nearest_vertex.query(points)[0], limit)
        # The margin keeps the box of the nearest vertex in spite of rounding.
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
        return self._choose(points, np.repeat(query, LEAF), _expand_boxes(box), limit)

    def _choose(
        self,
        points: Float[np.ndarray, "queries 3"],
        query: Int[np.ndarray, "pairs"],
        triangle: Int[np.ndarray, "pairs"],
        limit: float,
    ) -> ClosestPoints:
        """Choose the nearest triangle of each query; pairs are sorted by query."""
        away = points[query] - self.start[triangle]
        along = np.einsum("pix,px->pi", self.sides[triangle], away)
        second, third, reduction = _nearest_in_triangle(self.gram[triangle], along)
        squared = np.einsum("px,px->p", away, away) - reduction
        found, first = np.unique(query, return_index=True)
        best = np.full(len(points), np.inf)
        if len(found):
            best[found] = np.minimum.reduceat(squared, first)
        winners = np.flatnonzero(squared == best[query])
        found, first = np.unique(query[winners], return_index=True)
        winners = winners[first]
        return self._interpolate(
            points, found, triangle[winners], second[winners], third[winners], limit
        )

    def _interpolate(
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


def _order_triangles(
    middles: Float[np.ndarray, "triangles 3"],
) -> tuple[Int[np.ndarray, "slots"], int]:
    """Sort triangles so that those of a box are consecutive at every level; count the levels.

    The last boxes are filled by repeating a triangle.
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


def _bound_boxes(
    corners: Float[np.ndarray, "slots 3 3"], depth: int
) -> tuple[list[Float[np.ndarray, "_ 3"]], list[Float[np.ndarray, "_ 3"]]]:
    """Compute the lowest and highest corner of the 2, 4, 8, ... boxes of each level."""
    low = [corners.min(1).reshape(-1, LEAF, 3).min(1)]
    high = [corners.max(1).reshape(-1, LEAF, 3).max(1)]
    for _ in range(depth - 1):
        low.append(low[-1].reshape(-1, 2, 3).min(1))
        high.append(high[-1].reshape(-1, 2, 3).max(1))
    return low[::-1], high[::-1]


def _expand_boxes(box: Int[np.ndarray, "boxes"]) -> Int[np.ndarray, "members"]:
    return (LEAF * box[:, None] + np.arange(LEAF)).ravel()


def _nearest_in_triangle(
    gram: Float[np.ndarray, "pairs 2 2"], along: Float[np.ndarray, "pairs 2"]
) -> tuple[Float[np.ndarray, "pairs"], Float[np.ndarray, "pairs"], Float[np.ndarray, "pairs"]]:
    """Find (s, t) such that a + s ab + t ac is closest to p, with 0 <= s, t and s + t <= 1.

    `gram` has the scalar products of the sides ab and ac, `along` those of the sides with p - a.
    The point is the plane's closest one if that lies inside, else the best on the three edges. The
    third result is |p - a|^2 minus the squared distance.
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
    best = _reduction(best_s, best_t, bb, bc, cc, pb, pc)
    for s, t in ((zero, on_c), (1 - across, across)):
        reduction = _reduction(s, t, bb, bc, cc, pb, pc)
        better = ~inside & (reduction > best)
        best_s, best_t = np.where(better, s, best_s), np.where(better, t, best_t)
        best = np.where(better, reduction, best)
    return best_s, best_t, best


def _reduction(
    s: Float[np.ndarray, "pairs"],
    t: Float[np.ndarray, "pairs"],
    bb: Float[np.ndarray, "pairs"],
    bc: Float[np.ndarray, "pairs"],
    cc: Float[np.ndarray, "pairs"],
    pb: Float[np.ndarray, "pairs"],
    pc: Float[np.ndarray, "pairs"],
) -> Float[np.ndarray, "pairs"]:
    """Compute the squared distance from p to a, minus that from p to the point (s, t)."""
    return np.asarray(2 * (s * pb + t * pc) - s * s * bb - 2 * s * t * bc - t * t * cc)
