"""The maps of an albedo as files: their names, scales and record."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt16

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.images._mark import EDITED, Mark, parse_mark, read_mark
from skinnet.images._result_names import compute_digest
from skinnet.material._texture_file import import_openimageio

WHITES = {"melanin": 0.5, "hemoglobin": 0.25, "melanin_sd": 0.125, "hemoglobin_sd": 0.125}
"""Volume fractions of white in maps of 16 bits."""

MAPS = (*WHITES, "skin", "offset")
"""All maps; a file each."""

RECORD_END = "_maps.json"
_TOP = 65535


def to_pixels(fraction: Float32[np.ndarray, "*texels"], name: str) -> UInt16[np.ndarray, "*texels"]:
    """Convert fractions to the pixels of a map."""
    scaled = (fraction * np.float32(_TOP / WHITES[name])).clip(0, _TOP)
    return np.asarray(np.rint(scaled), np.uint16)


def to_fractions(
    pixels: UInt16[np.ndarray, "*texels"], name: str
) -> Float32[np.ndarray, "*texels"]:
    """Convert the pixels of a map to fractions."""
    return np.asarray(pixels * np.float32(WHITES[name] / _TOP), np.float32)


def name_map(stem: str, name: str, tile: int | None, texture: Path, is_float: bool) -> str:
    """Name the file of a map; the offset has a format that holds the texture's values."""
    suffix = choose_suffix(texture, is_float) if name == "offset" else ".png"
    return f"{stem}_{name}{'' if tile is None else f'.{tile}'}{suffix}"


def choose_suffix(texture: Path, is_float: bool) -> str:
    """Choose the ending of a file that loses nothing of a texture's values."""
    suffix = texture.suffix.lower()
    if suffix in (".tif", ".tiff"):
        return suffix
    return ".exr" if is_float else ".png"


def compute_set_digest(paths: Iterable[Path]) -> str:
    """Compute one digest of the files of a texture."""
    digests = [compute_digest(path) for path in paths]
    if len(digests) == 1:
        return digests[0]
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def owns(file: Path, digest: str) -> bool:
    """Whether a file is a result of the texture of a digest, so that it may be replaced."""
    mark = _read_own_mark(file)
    return mark is not None and mark.digest == digest


def describe_edited(path: Path) -> list[str]:
    """Say that a texture is the result of an edit, if it is."""
    mark = _read_own_mark(path)
    if mark is None or mark.part != EDITED:
        return []
    return [f"{path} was edited by skinnet; its skin is read as it is after the edit."]


def _read_own_mark(file: Path) -> Mark | None:
    if file.suffix == ".json":
        try:
            return parse_mark(json.loads(read_file(file, MOST_TEXT)).get("mark"))
        except (*READ_ERRORS, AttributeError):
            return None
    if file.suffix != ".exr":
        return read_mark(file)
    oiio = import_openimageio()
    source = oiio.ImageInput.open(str(file))
    if source is None:
        oiio.geterror()
        return None
    software = source.spec().getattribute("Software")
    source.close()
    return parse_mark(software)


def read_record(path: Path) -> dict[str, Any]:
    """Read the record that invert wrote, and check that all its maps are there.

    Raises:
        InputError: It is another file, or a map is missing.
    """
    try:
        record = json.loads(read_file(path, MOST_TEXT))
        files = [path.parent / name for tile in record["tiles"] for name in tile["files"].values()]
        known = {"light", "camera", "transform", "type", "linear"} <= record.keys()
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path} is not a NAME_maps.json of skinnet invert; give that, or the albedo."
        ) from error
    if not known:
        raise InputError(f"{path} is not a NAME_maps.json of skinnet invert; give that.")
    missing = [str(file) for file in files if not file.is_file()]
    if missing:
        raise InputError(f"{path} names {missing[0]}, which is missing; run skinnet invert again.")
    return dict(record)
