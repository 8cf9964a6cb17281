"""Vertex colours of glTF (COLOR_0), multiplied into the texture."""

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt

from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.mesh._texture_file import Texture
from skinnet.mesh.raster import rasterise

_TOLERANCE = 0.02
"""Largest difference of two colours, in [0, 1], that counts as rounding."""

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
    height, width = texture.shape[:2]
    size = max(height, width)
    square = corners * [width / size, height / size] * [1, -1] + [0, 1]
    first = _interpolate(square, colours, size)
    # A little smaller, so that neighbours do not share the texels on their edges.
    smaller = square + _SHRINK * (square.mean(1, keepdims=True) - square)
    last = _interpolate(smaller[::-1], colours[::-1], size)
    drawn = np.isfinite(first).all(-1)
    differing = np.abs(first - last)[drawn].max(-1, initial=0) > _TOLERANCE  # false for NaN
    if not drawn.any() or differing.mean() > _AMBIGUOUS:
        return None
    nearest = distance_transform_edt(~drawn, return_distances=False, return_indices=True)
    factor = first[tuple(nearest)][:height, :width]
    return to_uint8(linear_to_srgb(srgb_to_linear(texture) * factor))


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
