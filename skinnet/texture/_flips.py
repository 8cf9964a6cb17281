"""Triangles that a texture space flips."""

import numpy as np
from jaxtyping import Float, Int


def count_flipped_triangles(
    uv: Float[np.ndarray, "vertices 2"], triangles: Int[np.ndarray, "triangles 3"]
) -> int:
    """Count the triangles that are not counter-clockwise in a texture space.

    Args:
        uv: Texture coordinates of the vertices.
        triangles: Vertices of each triangle.

    Returns:
        The number of flipped or empty triangles.

    Example:
        >>> import numpy as np
        >>> from skinnet.texture._flips import count_flipped_triangles
        >>> corners = np.array([[0.0, 0], [1, 0], [0, 1]])
        >>> count_flipped_triangles(corners, np.array([[0, 1, 2], [0, 2, 1]]))
        1
    """
    a, b, c = np.moveaxis(uv[triangles], 1, 0)
    ab, ac = b - a, c - a
    return int((~(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0] > 0)).sum())
