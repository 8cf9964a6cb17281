"""The textures of a mesh's parts, packed into one picture."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.mesh._mesh_parts import MeshPart
from skinnet.mesh._texture_file import Texture

# Parts of one list have different sizes.
_Coordinates = Float[np.ndarray, "_ 2"]
_Triangles = Int[np.ndarray, "_ 3"]

PATCH = 4
"""Side in texels of the patch that holds the colour of a part without a texture."""


class Atlas(NamedTuple):
    """The triangles of all parts in one texture space, and its picture if it has one."""

    triangles: _Triangles
    uv: _Coordinates
    texture: Texture | None


class _Tile(NamedTuple):
    """Triangles of one part in a picture of its own."""

    triangles: _Triangles
    uv: _Coordinates
    texture: Texture


def pack_atlas(parts: list[MeshPart]) -> Atlas | None:
    """Pack the parts into one texture space.

    Parts that all have the same picture, or none, keep their coordinates. Otherwise coordinates
    outside [0, 1] are wrapped and the pictures are placed side by side.

    Returns:
        The atlas; None if a part has no coordinates and no part has a picture.
    """
    mapped = [(part.geometry.triangles, part.uv) for part in parts if part.uv is not None]
    textures = [part.texture for part in parts if part.uv is not None and part.texture is not None]
    if not textures:
        return _concatenate(mapped, None) if len(mapped) == len(parts) else None
    same = all(np.array_equal(texture, textures[0]) for texture in textures)
    if same and len(textures) == len(parts):
        return _concatenate(mapped, textures[0])
    return _place_side_by_side([_make_tile(part) for part in parts])


def wrap_coordinates(uv: _Coordinates, triangles: _Triangles) -> tuple[_Coordinates, _Triangles]:
    """Shift triangles outside [0, 1]^2 by whole tiles into it; clip coordinates still outside."""
    corners = uv[triangles]
    inside = ((corners >= 0) & (corners <= 1)).all((1, 2))[:, None, None]
    tiles = np.where(inside, 0, np.floor(corners.mean(1, keepdims=True)))
    tiled = np.concatenate([np.broadcast_to(tiles, corners.shape), triangles[..., None]], -1)
    rows = tiled.reshape(-1, 3)
    pairs, place = np.unique(rows, axis=0, return_inverse=True)
    wrapped = uv[pairs[:, 2].astype(np.int64)] - pairs[:, :2]
    return np.clip(wrapped, 0, 1), place.reshape(-1, 3)


def _make_tile(part: MeshPart) -> _Tile:
    """Make a tile of the part's picture, or of a patch of its colour."""
    triangles = part.geometry.triangles
    if part.uv is not None and part.texture is not None:
        uv, triangles = wrap_coordinates(part.uv, triangles)
        return _Tile(triangles, uv, part.texture)
    patch = np.tile(part.colour, (PATCH, PATCH, 1))
    return _Tile(np.zeros_like(triangles), np.full((1, 2), 0.5), patch)


def _place_side_by_side(tiles: list[_Tile]) -> Atlas:
    distinct: list[Texture] = []
    for tile in tiles:
        if not any(np.array_equal(tile.texture, other) for other in distinct):
            distinct.append(tile.texture)
    height = max(len(texture) for texture in distinct)
    padded = [np.pad(each, ((0, height - len(each)), (0, 0), (0, 0))) for each in distinct]
    left = np.cumsum([0] + [texture.shape[1] for texture in distinct])
    placed = []
    for triangles, uv, texture in tiles:
        number = next(i for i, other in enumerate(distinct) if np.array_equal(texture, other))
        u = (left[number] + uv[:, 0] * texture.shape[1]) / left[-1]
        v = 1 - (1 - uv[:, 1]) * len(texture) / height
        placed.append((triangles, np.stack([u, v], 1)))
    return _concatenate(placed, np.concatenate(padded, 1))


def _concatenate(mapped: list[tuple[_Triangles, _Coordinates]], texture: Texture | None) -> Atlas:
    starts = np.cumsum([0] + [len(uv) for _, uv in mapped[:-1]])
    shifted = [part + start for (part, _), start in zip(mapped, starts, strict=True)]
    return Atlas(np.concatenate(shifted), np.concatenate([uv for _, uv in mapped]), texture)
