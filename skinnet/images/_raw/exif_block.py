"""EXIF of RAW files: that of the TIFF files which most of them are, of CR3 and of RAF."""

import struct
from collections.abc import Iterator

from skinnet.files import READ_ERRORS
from skinnet.images._boxes import list_boxes
from skinnet.images._directories import (
    EXIF_IFD,
    GPS_IFD,
    Directory,
    Tag,
    read_directory,
    read_header,
    write_block,
)
from skinnet.images._segments import EXIF_PREFIX, list_segments

_DNG_VERSION = 0xC612

_DESCRIBED = frozenset({0x010E, 0x010F, 0x0110, 0x0131, 0x0132, 0x013B, 0x8298, EXIF_IFD, GPS_IFD})
"""Description, make, model, software, date, artist, copyright, and the directories below."""

_MAKER_NOTE = 0x927C
"""Its offsets are into the RAW file."""

_OTHER_MARKS = (b"IIRO", b"IIRS", b"IIU\0", b"MMOR", b"MMRO")
"""TIFF in all but its first bytes: Olympus and Panasonic."""

_RAF, _RAF_PREVIEW = b"FUJIFILMCCD-RAW", 84
_CANON = bytes.fromhex("85c0b687820f11e08111f4ce462b6a48")


def read_raw_exif(data: bytes) -> tuple[bytes, bool]:
    """Read the EXIF block of a RAW file, b"" for none, and whether the file is a DNG."""
    try:
        order, found = _merge(list(_list_blocks(data)))
    except READ_ERRORS:  # the pixels are read all the same
        return b"", False
    kept = {tag: _strip(item) for tag, item in found.items() if tag in _DESCRIBED}
    return (write_block(kept, order) if kept else b""), _DNG_VERSION in found


def _merge(blocks: list[bytes]) -> tuple[str, Directory]:
    """Byte order and tags; CR3 has a block of its own for each directory."""
    order = "<"
    found: Directory = {}
    for number, block in enumerate(blocks):
        header = read_header(block)
        tags = read_directory(block, header)
        if number == 0:
            order, found = header.order, tags
        else:
            found.setdefault(EXIF_IFD, tags)
    return order, found


def _list_blocks(data: bytes) -> Iterator[bytes]:
    if data.startswith(_OTHER_MARKS):
        yield data[:2] + (b"*\0" if data.startswith(b"II") else b"\0*") + data[4:]
    elif data.startswith(_RAF):
        start, length = struct.unpack_from(">II", data, _RAF_PREVIEW)
        for _, body in list_segments(data[start : start + length]):
            if body.startswith(EXIF_PREFIX):
                yield body[len(EXIF_PREFIX) :]
    elif data[4:8] == b"ftyp":
        yield from _list_canon_blocks(data)
    else:
        yield data


def _list_canon_blocks(data: bytes) -> Iterator[bytes]:
    for name, body in list_boxes(data):
        if name == b"moov":
            yield from _list_canon_blocks(body)
        elif name == b"uuid" and body.startswith(_CANON):
            boxes = dict(list_boxes(body[len(_CANON) :]))
            yield from (boxes[each] for each in (b"CMT1", b"CMT2") if each in boxes)


def _strip(item: Tag | Directory) -> Tag | Directory:
    if isinstance(item, Tag):
        return item
    return {tag: _strip(each) for tag, each in item.items() if tag != _MAKER_NOTE}
