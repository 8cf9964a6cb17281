"""Vertex colours of glTF (COLOR_0), multiplied into the texture."""

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt

from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.mesh._texture_file import Texture
from skinnet.mesh.raster import rasterise

_TOLERANCE = 0.02
"""Largest difference of two colours, in [0, 1], that counts as rounding."""

_MOST = 2048
"""Most texels along a side of the map of interpolated colours."""

_SHRINK = 1e-6

_AMBIGUOUS = 0.002
"""Largest share of texels whose triangles may have different colours, as at seams."""

# Row 0 is at the top, and texture coordinates have their origin there, as in glTF.
_Corners = Float[np.ndarray, "triangles 3 2"]
_Colours = Float[np.ndarray, "triangles 3 3"]


def bake_colours(texture: Texture, corners: _Corners, colours: _Colours) -> Texture | None:
    """Multiply a texture with the linear colours of the triangles' corners.

    Returns:
        The texture; None if faces of different colours use the same texels.
    """
    size = min(max(texture.shape[:2]), _MOST)
    square = corners * [1, -1] + [0, 1]
    first = _interpolate(square, colours, size)
    # A little smaller, so that neighbours do not share the texels on their edges.
    smaller = square + _SHRINK * (square.mean(1, keepdims=True) - square)
    last = _interpolate(smaller[::-1], colours[::-1], size)
    drawn = np.isfinite(first).all(-1)
    differing = np.abs(first - last)[drawn].max(-1, initial=0) > _TOLERANCE  # false for NaN
    if not drawn.any() or differing.mean() > _AMBIGUOUS:
        return None
    nearest = distance_transform_edt(~drawn, return_distances=False, return_indices=True)
    return _multiply(texture, first[tuple(nearest)])


def _multiply(texture: Texture, factor: Float[np.ndarray, "size size 3"]) -> Texture:
    """Multiply a texture with a map of factors that covers it, row by row to save memory."""
    height, width = texture.shape[:2]
    rows = (np.arange(height) + 0.5) * len(factor) // height
    columns = ((np.arange(width) + 0.5) * len(factor) // width).astype(np.int64)
    product = np.empty_like(texture)
    for row, place in enumerate(rows.astype(np.int64)):
        linear = srgb_to_linear(texture[row]) * factor[place, columns]
        product[row] = to_uint8(linear_to_srgb(linear))
    return product


def _interpolate(
    corners: _Corners, colours: _Colours, size: int
) -> Float[np.ndarray, "size size 3"]:
    """Interpolate colours at each texel, NaN where no triangle is."""
    raster = rasterise(corners, size)
    drawn = raster.triangle >= 0
    found = np.full((size, size, 3), np.nan, np.float32)
    weights = raster.barycentric[drawn]
    found[drawn] = np.einsum("nk,nkc->nc", weights, colours[raster.triangle[drawn]])
    return found
