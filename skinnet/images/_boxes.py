"""Boxes of JPEG 2000, HEIF and AVIF files."""

import struct
from collections.abc import Iterator

XMP_UUID = bytes.fromhex("be7acfcb97a942e89c71999491e3afac")
EXIF_UUID = b"JpgTiffExif->JP2"

_CODESTREAM, _DEPTH = b"\xff\x4f\xff\x51", 42

Box = tuple[bytes, bytes]
"""Name and content."""


def list_boxes(data: bytes) -> Iterator[Box]:
    """List the boxes of a file, or those in the content of a box."""
    at = 0
    while at + 8 <= len(data):
        size, name = struct.unpack_from(">I4s", data, at)
        head = 8
        if size == 1 and at + 16 <= len(data):
            size, head = struct.unpack_from(">Q", data, at + 8)[0], 16
        end = len(data) if size == 0 else at + size
        if end < at + head:
            return
        yield name, data[at + head : end]
        at = end


def join_boxes(boxes: list[Box]) -> bytes:
    """Join boxes; each states its length, so that others may follow the last one."""
    return b"".join(struct.pack(">I4s", len(body) + 8, name) + body for name, body in boxes)


def get_depth(data: bytes) -> int:
    """Bits of the first channel of a JPEG 2000 file."""
    at = data.find(_CODESTREAM)
    return (data[at + _DEPTH] & 0x7F) + 1 if 0 <= at < len(data) - _DEPTH else 8


def get_enumerated(data: bytes) -> int | None:
    """The number of the colour space that a JP2 file states, if it is one with a number."""
    header = dict(list_boxes(data)).get(b"jp2h", b"")
    colours = dict(list_boxes(header)).get(b"colr", b"")
    return struct.unpack_from(">I", colours, 3)[0] if colours[:1] == b"\x01" else None
