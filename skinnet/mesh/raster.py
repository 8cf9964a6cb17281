"""Rasterisation: the triangle at each texel of a map, and the texel's position in it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._barycentric import compute_barycentric_gradients

_SLACK = 1e-9
"""Triangles grow by this many texels, so that rounding opens no gap between neighbours."""

_LEVEL = 1e-13
"""An edge that rises by less than this per texel counts as parallel to the rows."""


class Raster(NamedTuple):
    """The triangle at the centre of each texel of a square map.

    Attributes:
        triangle: Index of the triangle, -1 where there is none.
        barycentric: Weights of its three corners, at least 0 and of sum 1; 0 where there is none.
    """

    triangle: Int[np.ndarray, "size size"]
    barycentric: Float[np.ndarray, "size size 3"]


class _Spans(NamedTuple):
    """Runs of texels, each in one row of one triangle."""

    triangle: Int[np.ndarray, "spans"]
    row: Int[np.ndarray, "spans"]
    first: Int[np.ndarray, "spans"]
    width: Int[np.ndarray, "spans"]


def rasterise(corners: Float[np.ndarray, "triangles 3 2"], size: int) -> Raster:
    """Rasterise triangles in texture coordinates onto a map of `size` x `size` texels.

    The texel of row r and column c has its centre at u = (c + .5) / size, v = 1 - (r + .5) / size.
    Where several triangles contain a centre (on an edge, or where they overlap), the first counts.

    Args:
        corners: Texture coordinates of each triangle's corners, in either orientation. Triangles
            without an area and parts outside [0, 1] are skipped.
        size: Texels along a side of the map.

    Returns:
        The raster, row 0 at the top.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import rasterise
        >>> lower_left = np.array([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
        >>> rasterise(lower_left, 3).triangle
        array([[ 0, -1, -1],
               [ 0,  0, -1],
               [ 0,  0,  0]], dtype=int32)
    """
    # In texels, x along columns and y along rows, so that centres lie at whole numbers.
    places = (corners * [1, -1] + [0, 1]) * size - 0.5
    gradients = compute_barycentric_gradients(places)
    spans = _find_spans(places, gradients, size)
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
    barycentric[held] = _locate(held, triangle[held], places, gradients, size)
    return Raster(triangle.reshape(size, size), barycentric.reshape(size, size, 3))


def _find_spans(
    places: Float[np.ndarray, "triangles 3 2"],
    gradients: Float[np.ndarray, "triangles 3 2"],
    size: int,
) -> _Spans:
    """Find the rows that each triangle crosses, and its columns in them."""
    y = np.where(np.isfinite(gradients[..., 0]), places[..., 1], np.inf)
    top = np.ceil(y.min(1) - _SLACK).clip(0, size).astype(np.int64)
    bottom = np.floor(y.max(1) + _SLACK).clip(-1, size - 1).astype(np.int64)
    count = np.where(top < size, bottom - top + 1, 0).clip(0)
    triangle = np.repeat(np.arange(len(places)), count)
    row = np.arange(len(triangle)) - (np.cumsum(count) - count - top)[triangle]
    low, high = _clip_rows(places, gradients, triangle, row)
    first = np.ceil(low).clip(0, size).astype(np.int64)
    last = np.floor(high).clip(-1, size - 1).astype(np.int64)
    kept = last >= first
    return _Spans(triangle[kept], row[kept], first[kept], (last - first + 1)[kept])


def _clip_rows(
    places: Float[np.ndarray, "triangles 3 2"],
    gradients: Float[np.ndarray, "triangles 3 2"],
    triangle: Int[np.ndarray, "spans"],
    row: Int[np.ndarray, "spans"],
) -> tuple[Float[np.ndarray, "spans"], Float[np.ndarray, "spans"]]:
    """Find where a row enters a triangle and where it leaves it; low > high if it misses."""
    low, high = np.full(len(row), -np.inf), np.full(len(row), np.inf)
    for k in range(3):
        # Coordinate k is 0 along the edge through corner k + 1: there
        # coordinate + slack = along (column - x) + down (row - y) + slack >= 0.
        x, y = places[:, (k + 1) % 3].T
        along, down = gradients[:, k].T
        slack = _SLACK * np.hypot(along, down)
        level = np.abs(along) <= _LEVEL * np.abs(down)
        ratio = 1 / np.where(level, 1, along)
        past = row - y[triangle]
        zero = (x - slack * ratio)[triangle] - (down * ratio)[triangle] * past
        inside = (down[triangle] * past >= -slack[triangle]) | ~level[triangle]
        low = np.where((along > 0)[triangle] & ~level[triangle], np.maximum(low, zero), low)
        high = np.where((along < 0)[triangle] & ~level[triangle], np.minimum(high, zero), high)
        low = np.where(inside, low, np.inf)
    return low, high


def _locate(
    texel: Int[np.ndarray, "texels"],
    triangle: Int[np.ndarray, "texels"],
    places: Float[np.ndarray, "triangles 3 2"],
    gradients: Float[np.ndarray, "triangles 3 2"],
    size: int,
) -> Float[np.ndarray, "texels 3"]:
    """Compute the barycentric coordinates of the centres of texels in their triangles."""
    row, column = np.divmod(texel, size)
    x, y = column - places[triangle, 0, 0], row - places[triangle, 0, 1]
    second = (gradients[triangle, 1, 0] * x + gradients[triangle, 1, 1] * y).clip(0, 1)
    third = (gradients[triangle, 2, 0] * x + gradients[triangle, 2, 1] * y).clip(0, 1 - second)
    return np.stack([1 - second - third, second, third], 1)
