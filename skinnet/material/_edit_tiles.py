"""The tiles that `skinnet edit-albedo` edits: textures, or textures put together from maps."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32
from numpy.typing import NDArray

from skinnet.material._calibrated_colour import make_colour
from skinnet.material._encoding import Encoding
from skinnet.material._invert_verb import invert_rows, open_all
from skinnet.material._map_files import (
    RECORD_END,
    choose_suffix,
    compute_set_digest,
    read_record,
    to_fractions,
)
from skinnet.material._texture_file import TextureFile, open_texture
from skinnet.material._texture_plane import read_plane
from skinnet.material._udim import find_corner, find_set
from skinnet.material.albedo import AlbedoColour, AlbedoMaps

_PIGMENTS = ("melanin", "hemoglobin")
Strips = Iterator[tuple[NDArray[Any], AlbedoMaps]]


class EditedTile(NamedTuple):
    """A tile to edit.

    Attributes:
        tile: Its number; None if the texture has no tiles.
        texture: The texture, or the offset of its maps.
        encoding: How colours are stored in it.
        strips: Reads its rows and their maps.
        name: What it is called.
    """

    tile: int | None
    texture: TextureFile
    encoding: Encoding
    strips: Callable[[AlbedoColour], Strips]
    name: str

    def place(self, rows: slice) -> tuple[NDArray[Any], NDArray[Any]]:
        """Places of the texels of rows: u of the columns, and v, upwards, of the rows."""
        spec, (u, v) = self.texture.spec, find_corner(self.tile)
        across = u + (np.arange(spec.width) + 0.5) / spec.width
        return across, v + 1 - (np.arange(rows.start, rows.stop) + 0.5) / spec.height

    def name_end(self) -> str:
        """The end of the name of its file, from the number on."""
        suffix = choose_suffix(self.texture.path, self.encoding.is_float)
        return f"{'' if self.tile is None else f'.{self.tile}'}{suffix}"


class TileSet(NamedTuple):
    """Tiles, their colours, the digest of their files, and where their edits go by default."""

    tiles: list[EditedTile]
    colour: AlbedoColour
    digest: str
    stem: str
    folder: Path


def open_tiles(options: argparse.Namespace, stack: ExitStack) -> TileSet:
    """Open a texture, or the maps of one; what is open is closed by the stack.

    Raises:
        InputError: Something cannot be read.
    """
    from_maps = options.texture.suffix.lower() == ".json"
    return (_open_maps if from_maps else _open_texture)(options, stack)


def _open_texture(options: argparse.Namespace, stack: ExitStack) -> TileSet:
    found = find_set(options.texture, options.partial)
    textures = open_all(found, options.space, stack)
    colour = make_colour(options, textures)
    digest = compute_set_digest(one.path for one in textures)
    tiles = []
    for (tile, path), texture in zip(found.list_files(), textures, strict=True):
        encoding = Encoding(texture.type, texture.linear)
        tiles.append(
            EditedTile(tile, texture, encoding, _make_reader(texture, encoding), str(path))
        )
    return TileSet(tiles, colour, digest, found.stem, found.pattern.parent)


def _make_reader(texture: TextureFile, encoding: Encoding) -> Callable[[AlbedoColour], Strips]:
    def read(colour: AlbedoColour) -> Strips:
        for stored in texture.read_strips():
            yield stored, invert_rows(stored, texture, encoding, colour).maps

    return read


def _open_maps(options: argparse.Namespace, stack: ExitStack) -> TileSet:
    path = options.texture
    record = read_record(path)
    transform = np.array(record["transform"], float)
    colour = AlbedoColour(record["light"], record["camera"], transform)
    tiles, files = [], []
    for one in record["tiles"]:
        names = {name: path.parent / file for name, file in one["files"].items()}
        files += list(names.values())
        offset = open_texture(names["offset"], "linear" if record["linear"] else "sRGB")
        stack.callback(offset.close)
        encoding = Encoding(record["type"], record["linear"])
        reader = _make_maps_reader(names, offset, encoding)
        tiles.append(EditedTile(one["tile"], offset, encoding, reader, str(path)))
    digest = compute_set_digest([path, *files])
    return TileSet(tiles, colour, digest, path.name.removesuffix(RECORD_END), path.parent)


def _make_maps_reader(
    names: dict[str, Path], offset: TextureFile, encoding: Encoding
) -> Callable[[AlbedoColour], Strips]:
    def read(colour: AlbedoColour) -> Strips:
        planes = {name: read_plane(names[name], offset) for name in (*_PIGMENTS, "skin")}
        top = 0
        for stored in offset.read_strips():
            rows = slice(top, top + len(stored))
            top += len(stored)
            f_mel, f_blood = (to_fractions(planes[name][rows], name) for name in _PIGMENTS)
            yield _restore(stored, offset, encoding, colour, f_mel, f_blood, planes["skin"][rows])

    return read


def _restore(
    stored: NDArray[Any],
    offset: TextureFile,
    encoding: Encoding,
    colour: AlbedoColour,
    f_mel: Float32[np.ndarray, "rows width"],
    f_blood: Float32[np.ndarray, "rows width"],
    skin: NDArray[Any],
) -> tuple[NDArray[Any], AlbedoMaps]:
    """Put rows of a texture together from its maps."""
    rgb, model = list(offset.rgb), colour.decode(f_mel, f_blood)
    whole = stored.astype(encoding.dtype)
    whole[..., rgb] = encoding.add(stored[..., rgb], model)
    nothing = np.zeros_like(f_mel)
    weight = skin.astype(np.float32) / np.float32(255)
    rest = encoding.decode(whole[..., rgb]) - model
    return whole, AlbedoMaps(f_mel, f_blood, nothing, nothing, weight, rest)
