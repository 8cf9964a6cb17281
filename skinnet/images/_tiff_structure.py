"""The directories of a TIFF file, by which a camera's RAW file is told from a picture."""

import os
import struct
from collections.abc import Iterator
from io import BufferedIOBase
from typing import Any, BinaryIO, NamedTuple

_SUBFILE, _COMPRESSION, _PHOTOMETRIC, _SUB_IFDS = 254, 259, 262, 330
_DNG_VERSION, _CR2_SLICES, _LEAF = 50706, 50752, 34310
_REDUCED = 1
_SENSOR = frozenset({32803, 34892})
"""Photometric interpretations of a sensor's values: colour filter array, and linear RAW."""

_CAMERA_COMPRESSIONS = frozenset({32767, 32769, 32770, 32867, 34713, 34892, 65000, 65535})
"""Compressions of Sony, Epson, Samsung, Kodak, Nikon, lossy DNG, Kodak and Pentax."""

_PLACES = {273: 279, 324: 325}
"""Offsets of strips and of tiles, and their lengths in bytes."""

_TYPES = {1: "B", 3: "H", 4: "I", 13: "I", 16: "Q", 18: "Q"}
_MOST_DIRECTORIES, _MOST_ENTRIES = 16, 512
_File = BinaryIO | BufferedIOBase
_Directory = dict[int, tuple[int, ...]]


class _Layout(NamedTuple):
    """How a file writes its directories: classic TIFF or BigTIFF, in either byte order."""

    order: str
    number: str
    entry: str
    offset: str


def is_raw(file: _File) -> bool:
    """Whether an open TIFF file is a camera's RAW file, whose first picture is but a preview."""
    head = _read(file, 0, 16)
    if head[8:10] == b"CR" or head[8:12] in (b"IIII", b"MMMM"):  # Canon CR2, Phase One
        return True
    for number, tags in enumerate(_list_directories(file, head)):
        if tags.keys() & {_DNG_VERSION, _CR2_SLICES, _LEAF}:
            return True
        if _SENSOR & {*tags.get(_PHOTOMETRIC, ())}:
            return True
        if _CAMERA_COMPRESSIONS & {*tags.get(_COMPRESSION, ())}:
            return True
        preview = tags.get(_SUBFILE, (0,))[0] & _REDUCED
        if number == 0 and preview and _SUB_IFDS in tags:
            return True
    return False


def find_sensor_end(file: _File) -> int:
    """Find where the values of the sensor end, as an open TIFF file states it; 0 if it does not.

    Raises:
        EOFError: A directory is missing.
    """
    ends = [0]
    for tags in _list_directories(file, _read(file, 0, 16)):
        if _SENSOR & {*tags.get(_PHOTOMETRIC, ())}:
            for start, size in _PLACES.items():
                ends += map(sum, zip(tags.get(start, ()), tags.get(size, ()), strict=False))
    return max(ends)


def _list_directories(file: _File, head: bytes) -> Iterator[_Directory]:
    order = "<" if head[:2] == b"II" else ">"
    big = head[2:4] in (b"+\0", b"\0+")
    layout = _Layout(order, "Q", "HHQ8s", "Q") if big else _Layout(order, "H", "HHI4s", "I")
    start = head[8:16] if big else head[4:8]
    waiting, seen = [struct.unpack(order + layout.offset, start)[0]], {0}
    while waiting and len(seen) <= _MOST_DIRECTORIES:
        place = waiting.pop(0)
        if place in seen:
            continue
        seen.add(place)
        tags, following = _read_directory(file, place, layout)
        yield tags
        waiting += [*tags.get(_SUB_IFDS, ()), following]


def _read_directory(file: _File, place: int, layout: _Layout) -> tuple[_Directory, int]:
    width = struct.calcsize(layout.order + layout.number)
    (count,) = struct.unpack(layout.order + layout.number, _read(file, place, width))
    size = struct.calcsize(layout.order + layout.entry)
    count = min(count, _MOST_ENTRIES)
    body = _read(file, place + width, count * size)
    tags: _Directory = {}
    for entry in struct.iter_unpack(layout.order + layout.entry, body):
        tags[entry[0]] = _read_values(file, entry, layout)
    end = _read(file, place + width + count * size, struct.calcsize(layout.order + layout.offset))
    return tags, struct.unpack(layout.order + layout.offset, end)[0]


def _read_values(file: _File, entry: tuple[Any, ...], layout: _Layout) -> tuple[int, ...]:
    _, type_, count, field = entry
    code = _TYPES.get(type_)
    if code is None or not 0 < count <= _MOST_DIRECTORIES:
        return ()
    form = f"{layout.order}{count}{code}"
    size = struct.calcsize(form)
    if size > len(field):
        (place,) = struct.unpack(layout.order + layout.offset, field)
        field = _read(file, place, size)
    return struct.unpack(form, field[:size])


def _read(file: _File, place: int, size: int) -> bytes:
    file.seek(place, os.SEEK_SET)
    data = file.read(size)
    if len(data) < size:
        raise EOFError(f"{size} bytes at {place} are missing")
    return data
