"""A textured triangle mesh: a scan, or a model fitted to one."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh with, where known, its texture.

    A vertex on a seam has one position and several texture coordinates, so triangles index texture
    coordinates separately.

    Args:
        vertices: Positions in any unit.
        triangles: Vertex indices, counter-clockwise seen from outside.
        uv: Texture coordinates in [0, 1] with the origin at the lower left of the picture.
        uv_triangles: Indices into `uv` of each triangle's corners.
        texture: sRGB picture, row 0 at the top.
        name: What error messages call the mesh.
        notes: Sentences on what was assumed when the mesh's file was read.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> Mesh(np.eye(3), np.array([[0, 1, 2]]), name="triangle").vertices.shape
        (3, 3)
    """

    vertices: Float[np.ndarray, "vertices 3"]
    triangles: Int[np.ndarray, "triangles 3"]
    uv: Float[np.ndarray, "points 2"] | None = None
    uv_triangles: Int[np.ndarray, "triangles 3"] | None = None
    texture: UInt8[np.ndarray, "height width 3"] | None = None
    name: str = "mesh"
    notes: tuple[str, ...] = ()
