"""Maps that `skinnet invert` wrote, with the texture they were made from, as inputs of a shader."""

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from skinnet.errors import InputError
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.material._map_files import RECORD_END, WHITES, compute_set_digest, read_record
from skinnet.material._texture_file import open_texture
from skinnet.material._udim import TOKEN, TextureSet

_PIGMENTS = {"melanin": "Melanin", "hemoglobin": "Hemoglobin"}
_WRITTEN = (*_PIGMENTS, "skin", "offset")


class ShaderMap(NamedTuple):
    """A texture that feeds an input of the shader: value = scale * what it gives + offset.

    Args:
        input: Melanin, Hemoglobin, Skin, Original or Offset.
        path: Its file, or a pattern of the files of its tiles.
        scale: Value of the file's largest number, less `offset`; 1 for files of floats.
        offset: Value of the number 0.
        space: Colour space of its numbers: raw, srgb or linear.
        tiles: Numbers of its UDIM tiles.
    """

    input: str
    path: Path
    scale: float = 1.0
    offset: float = 0.0
    space: str = "raw"
    tiles: tuple[int, ...] = ()


class MapRecord(NamedTuple):
    """What a NAME_maps.json says.

    Args:
        path: The file.
        content: Its content.
    """

    path: Path
    content: dict[str, Any]

    @property
    def light(self) -> str:
        """Light under which the maps were made."""
        return str(self.content["light"])

    @property
    def camera(self) -> str:
        """Camera for which the maps were made."""
        return str(self.content["camera"])

    @property
    def transform(self) -> Float64[np.ndarray, "3 3"]:
        """Colour transform that multiplies the model's RGB from the left."""
        return np.array(self.content["transform"], float).reshape(3, 3)

    @property
    def tiles(self) -> tuple[int, ...]:
        """Numbers of the tiles; none for a texture of one file."""
        return tuple(each["tile"] for each in self.content["tiles"] if each["tile"] is not None)

    def name(self, name: str) -> Path:
        """Name the file of a map, or the pattern of its tiles."""
        first = self.content["tiles"][0]
        file: str = first["files"][name]
        if self.tiles:
            before, _, after = file.rpartition(f".{first['tile']}")
            file = f"{before}.{TOKEN}{after}"
        return self.path.parent / file

    def list_inputs(self, names: Iterable[str], original: Path | None) -> list[ShaderMap]:
        """List what feeds the shader: pigments, and with the offset the texture and its skin.

        Args:
            names: Names of maps.
            original: The texture, where it has moved; None: where the record says.

        Raises:
            InputError: The texture is not there, or is another one.
        """
        maps = [
            ShaderMap(_PIGMENTS[name], self.name(name), WHITES[name], tiles=self.tiles)
            for name in _PIGMENTS
            if name in names
        ]
        if "offset" not in names:
            return maps
        texture = self._find_original() if original is None else self._check_original(original)
        space = "linear" if self.content["linear"] else "srgb"
        maps.append(ShaderMap("Skin", self.name("skin"), tiles=self.tiles))
        maps.append(ShaderMap("Original", texture, space=space, tiles=self.tiles))
        return maps

    def _find_original(self) -> Path:
        folder = Path(os.path.realpath(self.path.parent))
        given = self.content["input"]
        path = Path(os.path.normpath(folder / given["path"]))
        files = _list_tiles(path, self.tiles)
        if not all(each.is_file() for each in files):
            raise InputError(
                f"The texture {path} that {self.path} was made from is not there; give it by "
                "--original."
            )
        if compute_set_digest(files) != given["sha256"]:
            raise InputError(
                f"The texture {path} has changed since {self.path} was made; run skinnet invert "
                "again, or give the texture of the maps by --original."
            )
        return path

    def _check_original(self, path: Path) -> Path:
        for file, tile in zip(_list_tiles(path, self.tiles), self.content["tiles"], strict=True):
            texture = open_texture(file)
            size = [texture.spec.width, texture.spec.height]
            texture.close()
            if size != tile["size"]:
                raise InputError(
                    f"{file} is {size[0]} x {size[1]} and its maps are {tile['size'][0]} x "
                    f"{tile['size'][1]}; give the texture that {self.path} was made from."
                )
        return path


def _list_tiles(path: Path, tiles: tuple[int, ...]) -> list[Path]:
    return [file for _, file in TextureSet(path, tiles).list_files()]


def open_record(path: Path) -> MapRecord:
    """Open a NAME_maps.json.

    Raises:
        InputError: It is another file, or a map is missing.
    """
    record = MapRecord(path, read_record(path))
    try:
        [record.name(name) for name in _WRITTEN]
        record.transform, record.content["input"]["sha256"]
    except (LookupError, TypeError, ValueError) as error:
        raise InputError(f"{path} is not a NAME_maps.json of skinnet invert; give that.") from error
    return record


def find_record(path: Path) -> tuple[MapRecord, str] | None:
    """Find the record of a map, which lies beside it, and the map's name.

    A tile of a set stands for the set.
    """
    for name in _WRITTEN:
        stem, found, _ = path.name.rpartition(f"_{name}.")
        beside = path.with_name(stem + RECORD_END)
        if found and beside.is_file() and not _is_foreign(beside):
            record = open_record(beside)
            files = [record.name(name), *_list_tiles(record.name(name), record.tiles)]
            if path.name in {each.name for each in files}:
                return record, name
    return None


def _is_foreign(path: Path) -> bool:
    """Whether another verb, such as skinnet maps, wrote a record; a damaged one is not."""
    try:
        content = json.loads(read_file(path, MOST_TEXT))
    except (OSError, ValueError):
        return False
    return isinstance(content, dict) and "tiles" not in content
