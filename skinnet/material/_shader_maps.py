"""Maps of a texture as a shader reads them: which file is which map, and what its numbers mean."""

import math
import re
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError, _explain_fault
from skinnet.images._chunks import SIGNATURE, list_chunks
from skinnet.material._map_records import MapRecord, ShaderMap, find_record, open_record
from skinnet.material._udim import TOKEN

_INPUTS = {
    "melanin": "Melanin",
    "f_mel": "Melanin",
    "hemoglobin": "Hemoglobin",
    "f_blood": "Hemoglobin",
    "offset": "Offset",
}
"""Inputs of the shader by the names of maps."""

_WHITE = re.compile(r"(\w+): volume fraction, ([0-9.e-]+) at white")
"""How skinnet invert describes a map."""

_EXR = b"v/1\x01"
_AHEAD = 1 << 20
"""Bytes in which the texts of a map of skinnet lie, which come before its pixels."""


class ShaderMaps(NamedTuple):
    """The maps that a shader reads.

    Args:
        maps: The maps.
        record: What skinnet invert recorded of them; None: other maps.
    """

    maps: list[ShaderMap]
    record: MapRecord | None = None


def describe_maps(paths: Sequence[Path], original: Path | None = None) -> ShaderMaps:
    """Find which input each map feeds, and how its numbers are read.

    Args:
        paths: NAME_maps.json of skinnet invert, which stands for all its maps; or PNG files that
            say which map they hold, with their scale and offset, as skinnet writes them; or EXR
            files of floats, whose names end in the name of the map.
        original: The texture that skinnet invert read, where it has moved.

    Returns:
        The maps.

    Raises:
        InputError: A file cannot be read, is not a map of melanin, hemoglobin or the offset, or is
            one of two of a kind; or one pigment alone is given.
    """
    found = _gather(paths, original)
    _check_set(found.maps)
    if original is not None and all(each.input != "Original" for each in found.maps):
        raise InputError(
            f"--original {original} needs the maps that skinnet invert made of it; give "
            "NAME_maps.json."
        )
    return found


def _gather(paths: Sequence[Path], original: Path | None) -> ShaderMaps:
    records: dict[Path, MapRecord] = {}
    names, maps = [], []
    for path in paths:
        if path.suffix.lower() == ".json":
            record, given = open_record(path), ["melanin", "hemoglobin", "offset"]
        elif (found := find_record(path)) is not None:
            record, given = found[0], [found[1]]
        else:
            maps.append(_describe(path))
            continue
        records[record.path] = record
        names += given
    if len(records) > 1:
        both = " and ".join(map(str, records))
        raise InputError(f"The maps belong to {both}; give the maps of one texture.")
    whole = next(iter(records.values()), None)
    if whole is not None:
        maps += whole.list_inputs(names, original)
    return ShaderMaps(maps, whole)


def _describe(path: Path) -> ShaderMap:
    if TOKEN in path.name:
        raise InputError(
            f"{path} is a set of tiles without the NAME_maps.json of skinnet invert beside it; "
            "make the maps by skinnet invert, and give that."
        )
    try:
        with path.open("rb") as file:
            head = file.read(_AHEAD)
    except OSError as error:
        raise InputError(f"{path} cannot be read {_explain_fault(error)}.") from error
    if head.startswith(SIGNATURE):
        return _describe_png(path, head)
    name = path.stem.rpartition("_")[2]
    if head.startswith(_EXR) and name in _INPUTS:
        return ShaderMap(_INPUTS[name], path)
    raise InputError(
        f"{path} is no map of skinnet; give the PNG files of skinnet invert or skinnet maps, or "
        "EXR files of floats that end in _melanin.exr, _hemoglobin.exr or _offset.exr."
    )


def _describe_png(path: Path, head: bytes) -> ShaderMap:
    chunks = list(list_chunks(head, ahead=True))
    header = dict(chunks).get(b"IHDR", b"").ljust(13, b"\0")
    texts = dict(_read_texts(body for name, body in chunks if name == b"tEXt"))
    if described := _WHITE.match(texts.get("Description", texts.get("ImageDescription", ""))):
        name, white = described.groups()
        if name in _INPUTS:
            return ShaderMap(_INPUTS[name], path, float(white))
    name = texts.get("map", "")
    if name not in _INPUTS:
        held = f"the map {name!r}" if name else "no map with a scale"
        raise InputError(
            f"{path} holds {held}; a shader takes maps of melanin, hemoglobin and the offset, as "
            "skinnet invert and skinnet maps write them; the maps of skinnet invert need their "
            "NAME_maps.json beside them."
        )
    levels = (1 << struct.unpack(">IIBBBBB", header[:13])[2]) - 1
    scale, offset = (_read_number(path, texts, key) for key in ("scale", "offset"))
    return ShaderMap(_INPUTS[name], path, scale * levels, offset)


def _read_texts(bodies: Iterable[bytes]) -> Iterable[tuple[str, str]]:
    for body in bodies:
        key, _, value = body.partition(b"\0")
        yield key.decode("latin-1"), value.decode("latin-1")


def _read_number(path: Path, texts: dict[str, str], key: str) -> float:
    try:
        value = float(texts.get(key, ""))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"The {key} of {path} is {texts.get(key)!r}, which is no number; write the map again."
        )
    return value


def _check_set(maps: Sequence[ShaderMap]) -> None:
    inputs = [each.input for each in maps]
    for name in inputs:
        if inputs.count(name) > 1:
            both = " and ".join(str(each.path) for each in maps if each.input == name)
            raise InputError(f"{both} are both maps of the {name.lower()}; give one of them.")
    missing = {"Melanin", "Hemoglobin"} - {*inputs}
    if maps and missing:
        raise InputError(
            f"There is no map of the {min(missing).lower()} among the maps; give both pigments' "
            "maps, and the offset's if there is one."
        )
