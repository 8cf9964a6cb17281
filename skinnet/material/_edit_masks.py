"""Masks and painted maps of a texture's tiles."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.inference._edit_mask import read_edit_mask
from skinnet.material._edit_tiles import EditedTile
from skinnet.material._map_files import WHITES
from skinnet.material._texture_plane import check_size, read_plane
from skinnet.material._udim import TOKEN, TextureSet


def _find_tile(path: Path, tile: EditedTile) -> Path:
    """The file of a tile, where the path is a pattern or one tile of a set."""
    if tile.tile is None:
        return path
    named = TextureSet(path).name_tile(tile.tile)
    if TOKEN not in path.name or not named.exists():
        raise InputError(
            f"The texture has the tile {tile.tile}, and {path} has no such tile; draw one "
            f"for each tile, and name them by a pattern with {TOKEN}."
        )
    return named


def read_mask(path: Path | None, tile: EditedTile) -> NDArray[Any] | None:
    """Read the mask of a tile, [height, width]; None if there is no mask.

    Raises:
        InputError: It cannot be read, is of another size, or the tile has none.
    """
    if path is None:
        return None
    named = _find_tile(path, tile)
    mask = read_edit_mask(named, may_be_black=tile.tile is not None)
    check_size(named, mask.shape, tile.texture)
    return mask


def read_paint(path: Path, name: str, tile: EditedTile) -> Float32[np.ndarray, "height width"]:
    """Read the painted volume fractions of a tile, in [0, 1].

    Raises:
        InputError: As of `read_mask`.
    """
    named = _find_tile(path, tile)
    if not named.is_file():
        raise InputError(
            f"--{name}-paint is a volume fraction in [0, 1], or a painted map; got {path}."
        )
    values = read_plane(named, tile.texture)
    if values.dtype.kind == "f":
        return np.asarray(values.clip(0, 1), np.float32)
    return np.asarray(values * np.float32(WHITES[name] / np.iinfo(values.dtype).max), np.float32)
