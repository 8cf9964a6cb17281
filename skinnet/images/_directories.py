"""Directories of tags as EXIF and TIFF store them, read and written without loss of type."""

import struct
from mmap import mmap
from typing import NamedTuple, Union

_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4}
"""Bytes of a value by its type."""

_ASCII, _SHORT, _LONG, _RATIONAL = 2, 3, 4, 5
_BIG_OFFSETS = {16: 8, 17: 8, 18: 8}

EXIF_IFD, GPS_IFD, INTEROPERABILITY_IFD = 0x8769, 0x8825, 0xA005
_POINTERS = (EXIF_IFD, GPS_IFD, INTEROPERABILITY_IFD)
_MOST_TAGS = 4096


class Tag(NamedTuple):
    """A value as it is stored: its type, its length, and its bytes in the order of the file."""

    kind: int
    length: int
    value: bytes


Directory = dict[int, Union[Tag, "Directory"]]
"""Values and directories by tag."""


class Header(NamedTuple):
    """Byte order (`<` or `>`), whether offsets have 8 bytes, and where the first directory is."""

    order: str
    big: bool
    first: int


def read_header(data: bytes) -> Header:
    """Read the header of a TIFF file or of an EXIF block.

    Raises:
        ValueError: It is neither.
    """
    order = {b"II": "<", b"MM": ">"}.get(bytes(data[:2]))
    version = struct.unpack_from(f"{order}H", data, 2)[0] if order and len(data) >= 8 else 0
    if order is None or version not in (42, 43):
        raise ValueError("no TIFF header")
    big = version == 43
    letter, place = ("Q", 8) if big else ("I", 4)
    return Header(order, big, struct.unpack_from(order + letter, data, place)[0])


def read_directory(
    data: bytes | mmap, header: Header, at: int | None = None, depth: int = 0
) -> Directory:
    """Read a directory and those below it; what lies outside of the data is left out.

    Raises:
        ValueError: There is no directory at that place.
    """
    at = header.first if at is None else at
    found: Directory = {}
    for tag, kind, count, place in list_entries(data, header, at):
        size = (_SIZES | _BIG_OFFSETS).get(kind, 0) * count
        if size == 0:
            continue
        letter, width = ("Q", 8) if header.big else ("I", 4)
        start = place
        if size > width:
            start = struct.unpack_from(header.order + letter, data, place)[0]
        value = bytes(data[start : start + size])
        if len(value) < size:
            continue
        if tag in _POINTERS and depth < 2:
            inner = read_number(Tag(kind, count, value), header.order)
            found[tag] = read_directory(data, header, inner, depth + 1)
        elif kind in _SIZES:
            found[tag] = Tag(kind, count, value)
    return found


def list_entries(
    data: bytes | bytearray | mmap, header: Header, at: int
) -> list[tuple[int, int, int, int]]:
    """List tag, type, count, and the place of the value or of its offset, of each entry.

    Raises:
        ValueError: There is no directory at that place.
    """
    number, entry, start, value = ("Q", "HHQ", 8, 12) if header.big else ("H", "HHI", 2, 8)
    step = 20 if header.big else 12
    try:
        count = struct.unpack_from(header.order + number, data, at)[0]
        if count > _MOST_TAGS:
            raise ValueError(f"{count} tags in a directory")
        places = [at + start + step * index for index in range(count)]
        return [
            (*struct.unpack_from(header.order + entry, data, place), place + value)
            for place in places
        ]
    except struct.error as error:
        raise ValueError("a directory is cut short") from error


def read_number(tag: Tag, order: str) -> int:
    """Read the first number of a tag."""
    letter = {1: "B", 3: "H", 4: "I", 13: "I", 16: "Q", 18: "Q"}.get(tag.kind)
    if letter is None:
        raise ValueError(f"a number of type {tag.kind}")
    return int(struct.unpack_from(order + letter, tag.value)[0])


def make_text(text: str) -> Tag:
    """Make a tag of ASCII text."""
    value = text.encode("ascii", "replace") + b"\0"
    return Tag(_ASCII, len(value), value)


def make_short(number: int, order: str) -> Tag:
    """Make a tag of one number below 65536."""
    return Tag(_SHORT, 1, struct.pack(f"{order}H", number))


def make_rational(number: float, order: str) -> Tag:
    """Make a tag of one positive fraction."""
    return Tag(_RATIONAL, 1, struct.pack(f"{order}II", round(number * 10000), 10000))


def write_directory(directory: Directory, order: str, at: int) -> bytes:
    """Write a directory, whose first byte will lie at an offset, and those below it after it."""
    entries, tail = [], b""
    end = at + 2 + 12 * len(directory) + 4
    for tag, item in sorted(directory.items()):
        place = end + len(tail)
        if isinstance(item, dict):
            body, kind, count = write_directory(item, order, place), _LONG, 1
            value = struct.pack(f"{order}I", place)
        else:
            (kind, count, value), body = item, b""
            if len(value) > 4:
                value, body = struct.pack(f"{order}I", place), value
        tail += body + b"\0" * (len(body) % 2)
        entries.append(struct.pack(f"{order}HHI", tag, kind, count) + value.ljust(4, b"\0"))
    return struct.pack(f"{order}H", len(entries)) + b"".join(entries) + b"\0" * 4 + tail


def write_block(directory: Directory, order: str) -> bytes:
    """Write an EXIF block of a directory."""
    mark = b"II*\0" if order == "<" else b"MM\0*"
    return mark + struct.pack(f"{order}I", 8) + write_directory(directory, order, 8)
