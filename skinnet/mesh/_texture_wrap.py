"""Texture coordinates outside [0, 1] brought inside: repeated, mirrored or clamped."""

from enum import Enum
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.mesh._mesh_parts import MeshGeometry
from skinnet.mesh._texture_file import Texture
from skinnet.mesh._topology import weld

# Parts of a list have different sizes.
_Coordinates = Float[np.ndarray, "_ 2"]
_Corners = Float[np.ndarray, "_ 3"]


_MOST = 1 << 25
"""Texels to which a texture is continued, if it is not larger itself."""


class Wrap(Enum):
    """What a texture shows outside [0, 1]; the values are NumPy's modes of padding."""

    REPEAT = "wrap"
    MIRROR = "symmetric"
    CLAMP = "edge"


class Mapped(NamedTuple):
    """Triangles with texture coordinates, a row for each vertex, the origin at the upper left."""

    geometry: MeshGeometry
    uv: _Coordinates


def wrap_texture(
    parts: list[Mapped], texture: Texture, wraps: tuple[Wrap, Wrap], name: str
) -> tuple[list[Mapped], Texture]:
    """Bring the texture coordinates of parts with one texture into [0, 1].

    Triangles are moved by whole periods; for those that lie across a border, the texture is
    continued as far as they reach. Vertices whose triangles move differently are repeated at the
    end.

    Args:
        parts: The parts.
        texture: Their texture.
        wraps: What the texture shows beyond its left and right borders, and its upper and lower.
        name: What the message calls the mesh.

    Returns:
        The parts and the texture.

    Raises:
        InputError: If the texture would have to be continued far.
    """
    corners = [part.uv[part.geometry.triangles] for part in parts]
    every = np.concatenate(corners) if corners else np.zeros((0, 3, 2))
    if not np.isfinite(every).all() or ((every >= 0) & (every <= 1)).all():
        return parts, texture
    height, width = texture.shape[:2]
    columns, left, right = _place(every[..., 0], wraps[0], width)
    rows, top, bottom = _place(every[..., 1], wraps[1], height)
    shape = height + top + bottom, width + left + right
    if shape[0] * shape[1] > max(_MOST, 2 * height * width):
        raise InputError(
            f"{name} has faces that repeat their texture, from {every.min():.3g} to "
            f"{every.max():.3g} of it; unwrap it onto [0, 1]."
        )
    padded = np.pad(texture, ((0, 0), (left, right), (0, 0)), wraps[0].value)
    padded = np.pad(padded, ((top, bottom), (0, 0), (0, 0)), wraps[1].value)
    placed = np.stack([columns / shape[1], rows / shape[0]], -1)
    ends = np.cumsum([len(each) for each in corners])[:-1]
    moved = np.split(placed, ends)
    return [_repeat(part, uv) for part, uv in zip(parts, moved, strict=True)], padded


def _place(value: _Corners, wrap: Wrap, size: int) -> tuple[_Corners, int, int]:
    """Move one coordinate by periods; return it in texels, and how far the texture continues."""
    middle = value.mean(1, keepdims=True)
    inside = ((value >= 0) & (value <= 1)).all(1, keepdims=True)
    if wrap is Wrap.REPEAT:
        moved = value - np.floor(middle)
    elif wrap is Wrap.MIRROR:
        period = 2 * np.floor(middle / 2)
        moved = np.where(middle - period > 1, 2 - (value - period), value - period)
    else:
        beyond = (value <= 0).all(1, keepdims=True) | (value >= 1).all(1, keepdims=True)
        moved = np.where(beyond, value.clip(0, 1), value)
    texels = np.where(inside, value, moved) * size
    # The outermost half of a texel has the colour of its middle, here and where it is sampled.
    before, after = max(-texels.min(), 0), max(texels.max() - size, 0)
    low = 0 if before <= 0.5 else int(np.ceil(before))
    high = 0 if after <= 0.5 else int(np.ceil(after))
    return (texels + low).clip(0, low + size + high), low, high


def _repeat(part: Mapped, corners: Float[np.ndarray, "_ 3 2"]) -> Mapped:
    """Give each vertex as many rows as its corners have different coordinates."""
    vertices, triangles = part.geometry
    rows = np.column_stack([triangles.ravel(), corners.reshape(-1, 2)])
    first, place = np.unique(weld(rows), return_inverse=True)
    used = triangles.ravel()[first]
    geometry = MeshGeometry(
        np.concatenate([vertices, vertices[used]]), len(vertices) + place.reshape(-1, 3)
    )
    return Mapped(geometry, np.concatenate([np.zeros((len(vertices), 2)), rows[first, 1:]]))
