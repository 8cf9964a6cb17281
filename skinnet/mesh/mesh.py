"""A textured triangle mesh: a scan, or a model fitted to one."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8


@dataclass(frozen=True)
class Mesh:
    """A surface in three dimensions with, where known, its texture.

    `vertices` [V, 3] in any unit, `triangles` [T, 3] into them, counter-clockwise from outside.
    `uv` [U, 2] in [0, 1] with the origin at the lower left of the picture, and `uv_triangles`
    [T, 3] into it, so that a vertex on a seam has one position and several texture coordinates.
    `texture` is uint8 sRGB [H, W, 3], its first row the top. `name` is for messages.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]
    uv: Float[np.ndarray, "points 2"] | None = None
    uv_triangles: Int[np.ndarray, "triangles 3"] | None = None
    texture: UInt8[np.ndarray, "height width 3"] | None = None
    name: str = "mesh"
