"""Which triangle each texel of a map lies in, and where in it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

SLACK = 1e-9
"""Texels by which a triangle is grown, so that rounding opens no gap between neighbours."""

EMPTY = 1e-12
"""A triangle whose height is less than about this share of its length has no area."""

LEVEL = 1e-13
"""An edge that rises less than this share of a texel a texel is taken as a row's."""


class Raster(NamedTuple):
    """`triangle` is -1 and `barycentric` 0 where a texel's centre lies in no triangle."""

    triangle: Int[np.ndarray, "size size"]
    barycentric: Float[np.ndarray, "size size 3"]


class _Rows(NamedTuple):
    """Stretches of texels, each in one row of one triangle."""

    triangle: Int[np.ndarray, "spans"]
    row: Int[np.ndarray, "spans"]
    first: Int[np.ndarray, "spans"]
    width: Int[np.ndarray, "spans"]


def rasterise(corners: Float[np.ndarray, "triangles 3 2"], size: int) -> Raster:
    """Triangles in texture coordinates onto a map of `size` x `size` texels.

    The texel of row r and column c has its centre at u = (c + .5) / size, v = 1 - (r + .5) / size
    and belongs to the triangle that holds it, of several (a centre on an edge, an overlap) to the
    first. Triangles of either orientation count, those without an area and those outside [0, 1] do
    not. Barycentric coordinates are float64, at least 0 and of unit sum.
    """
    # In texels, x along columns and y along rows, so that centres lie at whole numbers.
    places = (corners * [1, -1] + [0, 1]) * size - 0.5
    change = barycentric_gradients(places)
    spans = _spans(places, change, size)
    span = np.repeat(np.arange(len(spans.row)), spans.width)
    starts = np.cumsum(spans.width) - spans.width
    column = np.arange(len(span)) - (starts - spans.first)[span]
    # A texel written several times keeps the last value: the first triangle comes last.
    texel = (spans.row[span] * size + column)[::-1]
    owner = spans.triangle[span][::-1]
    triangle = np.full(size * size, -1, np.int32)
    triangle[texel] = owner
    held = np.flatnonzero(triangle >= 0)
    barycentric = np.zeros((size * size, 3))
    barycentric[held] = _barycentric(held, triangle[held], places, change, size)
    return Raster(triangle.reshape(size, size), barycentric.reshape(size, size, 3))


def barycentric_gradients(
    places: Float[np.ndarray, "triangles 3 2"],
) -> Float[np.ndarray, "triangles 3 2"]:
    """Change of barycentric coordinate k for a step along x and y; nan for an empty triangle."""
    ahead, behind = np.roll(places, -1, 1), np.roll(places, -2, 1)
    across = behind - ahead
    double = (across[:, 2, 0] * across[:, 0, 1] - across[:, 2, 1] * across[:, 0, 0])[:, None]
    empty = np.abs(double) <= EMPTY * (across**2).sum((1, 2))[:, None]
    double = np.where(empty, np.nan, double)
    return np.stack([-across[..., 1] / double, across[..., 0] / double], -1)


def _spans(
    places: Float[np.ndarray, "triangles 3 2"],
    change: Float[np.ndarray, "triangles 3 2"],
    size: int,
) -> _Rows:
    """The rows that each triangle crosses, and its columns there."""
    y = np.where(np.isfinite(change[..., 0]), places[..., 1], np.inf)
    top = np.ceil(y.min(1) - SLACK).clip(0, size).astype(np.int64)
    bottom = np.floor(y.max(1) + SLACK).clip(-1, size - 1).astype(np.int64)
    count = np.where(top < size, bottom - top + 1, 0).clip(0)
    triangle = np.repeat(np.arange(len(places)), count)
    row = np.arange(len(triangle)) - (np.cumsum(count) - count - top)[triangle]
    low, high = _between(places, change, triangle, row)
    first = np.ceil(low).clip(0, size).astype(np.int64)
    last = np.floor(high).clip(-1, size - 1).astype(np.int64)
    kept = last >= first
    return _Rows(triangle[kept], row[kept], first[kept], (last - first + 1)[kept])


def _between(
    places: Float[np.ndarray, "triangles 3 2"],
    change: Float[np.ndarray, "triangles 3 2"],
    triangle: Int[np.ndarray, "spans"],
    row: Int[np.ndarray, "spans"],
) -> tuple[Float[np.ndarray, "spans"], Float[np.ndarray, "spans"]]:
    """Where a row enters a triangle and leaves it; the first is the larger if it passes by."""
    low, high = np.full(len(row), -np.inf), np.full(len(row), np.inf)
    for k in range(3):
        # Coordinate k is 0 along the edge through corner k + 1: there
        # coordinate + slack = along (column - x) + down (row - y) + slack >= 0.
        x, y = places[:, (k + 1) % 3].T
        along, down = change[:, k].T
        slack = SLACK * np.hypot(along, down)
        level = np.abs(along) <= LEVEL * np.abs(down)
        ratio = 1 / np.where(level, 1, along)
        past = row - y[triangle]
        zero = (x - slack * ratio)[triangle] - (down * ratio)[triangle] * past
        inside = (down[triangle] * past >= -slack[triangle]) | ~level[triangle]
        low = np.where((along > 0)[triangle] & ~level[triangle], np.maximum(low, zero), low)
        high = np.where((along < 0)[triangle] & ~level[triangle], np.minimum(high, zero), high)
        low = np.where(inside, low, np.inf)
    return low, high


def _barycentric(
    texel: Int[np.ndarray, "texels"],
    triangle: Int[np.ndarray, "texels"],
    places: Float[np.ndarray, "triangles 3 2"],
    change: Float[np.ndarray, "triangles 3 2"],
    size: int,
) -> Float[np.ndarray, "texels 3"]:
    row, column = np.divmod(texel, size)
    x, y = column - places[triangle, 0, 0], row - places[triangle, 0, 1]
    second = (change[triangle, 1, 0] * x + change[triangle, 1, 1] * y).clip(0, 1)
    third = (change[triangle, 2, 0] * x + change[triangle, 2, 1] * y).clip(0, 1 - second)
    return np.stack([1 - second - third, second, third], 1)
