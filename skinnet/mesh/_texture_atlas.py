"""The textures of a mesh's parts in one picture."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, UInt8

# Parts of one list have different sizes.
Picture = UInt8[np.ndarray, "_ _ 3"]
Points = Float[np.ndarray, "_ 2"]
Triangles = Int[np.ndarray, "_ 3"]

PATCH = 4
"""Side in texels of the patch that stands for a part of one colour."""


class Page(NamedTuple):
    """A part's triangles into its texture coordinates, and its picture; its colour without them."""

    triangles: Triangles
    uv: Points | None
    picture: Picture | None
    colour: UInt8[np.ndarray, "3"]


class AtlasTile(NamedTuple):
    """Triangles into texture coordinates in a picture."""

    triangles: Triangles
    uv: Points
    picture: Picture


class Atlas(NamedTuple):
    """All parts, one after the other, in one texture space."""

    triangles: Triangles
    uv: Points
    picture: Picture | None


def pack_atlas(pages: list[Page]) -> Atlas | None:
    """The parts in one texture space; None if some have no coordinates and none has a picture.

    Parts that all have the same picture, or none, keep their coordinates. Otherwise the pictures
    are laid side by side, coordinates outside [0, 1] wrapped first.
    """
    mapped = [(page.triangles, page.uv) for page in pages if page.uv is not None]
    pictures = [page.picture for page in pages if page.uv is not None and page.picture is not None]
    if not pictures:
        return _listed(mapped, None) if len(mapped) == len(pages) else None
    one = all(np.array_equal(picture, pictures[0]) for picture in pictures)
    if one and len(pictures) == len(pages):
        return _listed(mapped, pictures[0])
    return _side_by_side([_sheet(page) for page in pages])


def wrap_coordinates(uv: Points, triangles: Triangles) -> tuple[Points, Triangles]:
    """Triangles in other tiles of the plane moved onto [0, 1]^2; what still juts out is cut off."""
    corners = uv[triangles]
    inside = ((corners >= 0) & (corners <= 1)).all((1, 2))[:, None, None]
    tiles = np.where(inside, 0, np.floor(corners.mean(1, keepdims=True)))
    tiled = np.concatenate([np.broadcast_to(tiles, corners.shape), triangles[..., None]], -1)
    rows = tiled.reshape(-1, 3)
    pairs, place = np.unique(rows, axis=0, return_inverse=True)
    wrapped = uv[pairs[:, 2].astype(np.int64)] - pairs[:, :2]
    return np.clip(wrapped, 0, 1), place.reshape(-1, 3)


def _sheet(page: Page) -> AtlasTile:
    """A part with its picture, or with a patch of its colour."""
    if page.uv is not None and page.picture is not None:
        uv, triangles = wrap_coordinates(page.uv, page.triangles)
        return AtlasTile(triangles, uv, page.picture)
    patch = np.tile(page.colour, (PATCH, PATCH, 1))
    return AtlasTile(np.zeros_like(page.triangles), np.full((1, 2), 0.5), patch)


def _side_by_side(sheets: list[AtlasTile]) -> Atlas:
    distinct: list[Picture] = []
    for sheet in sheets:
        if not any(np.array_equal(sheet.picture, other) for other in distinct):
            distinct.append(sheet.picture)
    height = max(len(picture) for picture in distinct)
    padded = [np.pad(each, ((0, height - len(each)), (0, 0), (0, 0))) for each in distinct]
    left = np.cumsum([0] + [picture.shape[1] for picture in distinct])
    moved = []
    for triangles, uv, picture in sheets:
        number = next(i for i, other in enumerate(distinct) if np.array_equal(picture, other))
        u = (left[number] + uv[:, 0] * picture.shape[1]) / left[-1]
        v = 1 - (1 - uv[:, 1]) * len(picture) / height
        moved.append((triangles, np.stack([u, v], 1)))
    return _listed(moved, np.concatenate(padded, 1))


def _listed(mapped: list[tuple[Triangles, Points]], picture: Picture | None) -> Atlas:
    starts = np.cumsum([0] + [len(uv) for _, uv in mapped[:-1]])
    moved = [part + start for (part, _), start in zip(mapped, starts, strict=True)]
    return Atlas(np.concatenate(moved), np.concatenate([uv for _, uv in mapped]), picture)
