"""What a picture file states of its colours, format by format."""

import struct
from collections.abc import Iterator
from typing import Any, NamedTuple

from PIL import Image

from skinnet.files import READ_ERRORS
from skinnet.images._boxes import list_boxes
from skinnet.images._chunks import list_chunks
from skinnet.images._icc import Primaries

_BOXES = {b"jp2h", b"meta", b"iprp", b"ipco"}
"""Boxes on the way to a colr box in HEIF, AVIF and JPEG 2000 files."""

_EXIF, _INTEROPERABILITY = 0x8769, 0xA005
_COLOUR_SPACE, _GAMMA = 0xA001, 0xA500
_WHITE_POINT, _PRIMARIES, _MAKE = 0x013E, 0x013F, 0x010F


class ColrBox(NamedTuple):
    """The colr boxes of a file: a profile, and code points of primaries and transfer."""

    profile: bytes | None
    code_points: tuple[int, int] | None
    enumerated: int | None


class ExifColour(NamedTuple):
    """What EXIF states of the colours.

    `space` is tag 0xA001; `interoperability` is the index of that directory, "" if it cannot be
    read, and None if there is no directory.
    """

    space: int | None
    interoperability: str | None
    primaries: Primaries | None
    exponent: float | None
    make: str


class BmpColour(NamedTuple):
    """What the header of a BMP file states: a profile, or primaries and an exponent."""

    profile: bytes | None
    primaries: Primaries | None
    exponent: float | None


def read_cicp(data: bytes) -> tuple[int, int, int] | None:
    """Primaries, transfer and full range of a PNG's cICP chunk."""
    for name, body in list_chunks(data, ahead=True):
        if name == b"cICP" and len(body) == 4:
            return body[0], body[1], body[3]
    return None


def read_colr(data: bytes) -> ColrBox:
    """The colr boxes of a HEIF, AVIF or JPEG 2000 file."""
    profile, code_points, enumerated = None, None, None
    for body in _find_colr(data):
        kind = body[:4]
        if kind in (b"prof", b"rICC"):
            profile = profile or body[4:]
        elif kind == b"nclx" and len(body) >= 8:
            code_points = code_points or struct.unpack_from(">HH", body, 4)
        elif body[:1] in (b"\x02", b"\x03"):
            profile = profile or body[3:]
        elif body[:1] == b"\x01" and len(body) >= 7:
            enumerated = struct.unpack_from(">I", body, 3)[0]
    return ColrBox(profile, code_points, enumerated)


def read_exif_colour(image: Image.Image) -> ExifColour:
    """What EXIF states of the colours; nothing if it is damaged."""
    try:
        exif = image.getexif()
        inner = exif.get_ifd(_EXIF)
        return ExifColour(
            _as_int(inner.get(_COLOUR_SPACE)),
            _read_index(exif, inner),
            read_primaries(exif.get(_WHITE_POINT), exif.get(_PRIMARIES)),
            _as_exponent(inner.get(_GAMMA)),
            str(exif.get(_MAKE) or "").strip("\0 "),
        )
    except READ_ERRORS:
        return ExifColour(None, None, None, None, "")


def read_bmp(data: bytes) -> BmpColour:
    """What a BMP header of version 4 or 5 states of the colours."""
    try:
        size = struct.unpack_from("<I", data, 14)[0]
        kind = data[70:74][::-1] if size >= 108 else b""
        if kind == b"MBED" and size >= 124:
            start, length = struct.unpack_from("<II", data, 126)
            return BmpColour(data[14 + start : 14 + start + length], None, None)
        if kind == b"\0\0\0\0":
            ends = [value / 2**30 for value in struct.unpack_from("<9i", data, 74)]
            gamma = struct.unpack_from("<I", data, 110)[0] / 2**16
            return BmpColour(None, _from_xyz(ends), gamma or None)
    except (struct.error, ZeroDivisionError):
        pass
    return BmpColour(None, None, None)


def read_primaries(white: Any, primaries: Any) -> Primaries | None:
    """Primaries from a white (x, y) and three pairs; None if they enclose no area."""
    try:
        x, y = (float(value) for value in white)
        pairs = [float(value) for value in primaries]
        found = Primaries((x, y), (pairs[0], pairs[1]), (pairs[2], pairs[3]), (pairs[4], pairs[5]))
    except (TypeError, ValueError, IndexError, ZeroDivisionError):
        return None
    return found if is_triangle(found) else None


def is_triangle(primaries: Primaries) -> bool:
    """Whether the primaries enclose an area with the white inside it."""
    r, g, b = primaries[1:]
    areas = [_area(primaries.white, *side) for side in ((r, g), (g, b), (b, r))]
    return all(area > 1e-4 for area in areas) or all(area < -1e-4 for area in areas)


def _area(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _from_xyz(ends: list[float]) -> Primaries | None:
    triples = [ends[0:3], ends[3:6], ends[6:9]]
    white = [sum(values) for values in zip(*triples, strict=True)]
    (wx, wy), *corners = [(x / (x + y + z), y / (x + y + z)) for x, y, z in [white, *triples]]
    return read_primaries((wx, wy), [value for pair in corners for value in pair])


def _find_colr(data: bytes) -> Iterator[bytes]:
    """Contents of the colr boxes of a file or of a box."""
    for name, body in list_boxes(data):
        if name == b"colr":
            yield body
        elif name in _BOXES:
            yield from _find_colr(body[4:] if name == b"meta" else body)


def _read_index(exif: Image.Exif, inner: dict[int, Any]) -> str | None:
    if _INTEROPERABILITY not in inner:
        return None
    index = exif.get_ifd(_INTEROPERABILITY).get(1, "")
    text = index.decode("latin-1") if isinstance(index, bytes) else str(index)
    return text.strip("\0 ").upper()


def _as_int(value: Any) -> int | None:
    try:
        return int(value[0] if isinstance(value, tuple) else value)
    except (TypeError, ValueError):
        return None


def _as_exponent(value: Any) -> float | None:
    try:
        return float(value) or None
    except (TypeError, ValueError, ZeroDivisionError):
        return None
