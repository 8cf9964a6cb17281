"""Polygons cut into triangles, concave ones too."""

import numpy as np
from jaxtyping import Bool, Float, Int


def cut_polygons(
    positions: Float[np.ndarray, "corners 3"], counts: Int[np.ndarray, "polygons"]
) -> tuple[Int[np.ndarray, "triangles 3"], Int[np.ndarray, "triangles"]]:
    """Cut polygons, given by the positions of their corners one after the other, into triangles.

    Returns:
        The corners of each triangle, and its polygon. Polygons below three corners have none.
    """
    starts = np.cumsum(counts) - counts
    triangles, owners = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
    for count in np.unique(counts[counts >= 3]).tolist():
        polygons = np.flatnonzero(counts == count)
        local = np.repeat(_fan(count)[None], len(polygons), 0)
        if count > 3:
            corners = positions[starts[polygons][:, None] + np.arange(count)]
            for place in np.flatnonzero(_find_concave(corners)):
                local[place] = _clip_ears(corners[place])
        triangles.append((starts[polygons][:, None, None] + local).reshape(-1, 3))
        owners.append(np.repeat(polygons, count - 2))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(triangles)[order], owner[order]


def _fan(count: int) -> Int[np.ndarray, "triangles 3"]:
    after = np.arange(1, count - 1)
    return np.stack([0 * after, after, after + 1], 1)


def _find_concave(corners: Float[np.ndarray, "polygons n 3"]) -> Bool[np.ndarray, "polygons"]:
    """Find polygons in which a triangle of the fan has no area, or is turned against the others."""
    arms = corners[:, 1:] - corners[:, :1]
    normals = np.cross(arms[:, :-1], arms[:, 1:])
    whole = normals.sum(1)
    along = np.einsum("pti,pi->pt", normals, whole)
    size = (whole**2).sum(1)
    return np.asarray((along <= 1e-9 * size[:, None]).any(1) & (size > 0))


def _clip_ears(corners: Float[np.ndarray, "n 3"]) -> Int[np.ndarray, "triangles 3"]:
    """Cut off the ears of one polygon (Meisters 1975), in the plane of its normal."""
    arms = corners[1:] - corners[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(0)
    axis = int(np.abs(normal).argmax())
    # Cyclic, so that the projected polygon keeps its orientation; reversed for a negative normal.
    plane = corners[:, [(axis + 1) % 3, (axis + 2) % 3]]
    points = plane if normal[axis] > 0 else plane[:, ::-1]
    left, triangles = list(range(len(points))), []
    while len(left) > 3:
        ears = (place for place in range(len(left)) if _is_ear(points, left, place))
        place = next(ears, 0)  # a polygon that crosses itself has no right triangles
        triangles.append([left[place - 1], left[place], left[(place + 1) % len(left)]])
        del left[place]
    return np.array([*triangles, left])


def _is_ear(points: Float[np.ndarray, "n 2"], left: list[int], place: int) -> bool:
    a, b, c = left[place - 1], left[place], left[(place + 1) % len(left)]
    if _turn(points[a], points[b], points[c]) <= 0:
        return False
    corners = points[[a, b, c]]
    others = [each for each in left if not (corners == points[each]).all(1).any()]
    return not any(
        min(_turn(corners[k - 1], corners[k], points[each]) for k in range(3)) >= 0
        for each in others
    )


def _turn(a: Float[np.ndarray, "2"], b: Float[np.ndarray, "2"], c: Float[np.ndarray, "2"]) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
