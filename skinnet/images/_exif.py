"""EXIF of an edited photograph: as it was, apart from what the edit makes untrue."""

import re
import struct

from skinnet.images._directories import (
    EXIF_IFD,
    Directory,
    Header,
    Tag,
    list_entries,
    make_rational,
    make_short,
    make_text,
    read_header,
    read_number,
    write_block,
)

ORIENTATION, PROCESSING_SOFTWARE = 0x0112, 0x000B
_X_RESOLUTION, _Y_RESOLUTION, _RESOLUTION_UNIT = 0x011A, 0x011B, 0x0128
_WIDTHS, _HEIGHTS = (0x0100, 0xA002), (0x0101, 0xA003)
_THUMBNAILS = {0x0201: 0x0202, 0x0111: 0x0117}
"""Where a thumbnail lies and how long it is: a JPEG file, or strips."""

_FORMATS = {1: "B", 3: "H", 4: "I"}
_PREFIX = b"Exif\0\0"
_INCH = 2


def strip_prefix(block: bytes) -> bytes:
    """Return an EXIF block without the prefix that JPEG has before it."""
    while block.startswith(_PREFIX):
        block = block[len(_PREFIX) :]
    return block


def read_orientation(block: bytes, xmp: bytes = b"") -> int:
    """Read the orientation that EXIF states or, where it states none, XMP."""
    try:
        header = read_header(block)
        for tag, kind, count, place in list_entries(block, header, header.first):
            if tag == ORIENTATION and kind in _FORMATS and count == 1:
                return int(struct.unpack_from(header.order + _FORMATS[kind], block, place)[0])
    except (ValueError, struct.error):
        pass
    found = re.search(rb"""tiff:Orientation(?:\s*=\s*["']|\s*>)\s*([1-8])""", xmp)
    return int(found[1]) if found else 1


def update_exif(
    block: bytes, size: tuple[int, int], line: str, dpi: tuple[float, float] | None = None
) -> bytes:
    """Update the EXIF of a picture that has been edited and turned upright.

    Orientation becomes 1, sizes in pixels are those of the picture, and the thumbnail, which shows
    the photograph before the edit, is removed. Everything else stays where it is in the block: the
    notes of a camera's maker hold offsets into it.

    Args:
        block: The EXIF block; b"" for none.
        size: Width and height of the picture.
        line: Text of the tag ProcessingSoftware; "" for none.
        dpi: Resolution to state where the block states none.

    Raises:
        ValueError: The block is damaged.
    """
    if not block:
        added = _list_added({}, "<", line, dpi)
        return write_block(added, "<") if added else b""
    header = read_header(block)
    if header.big:
        raise ValueError("EXIF with offsets of 8 bytes")
    buffer = bytearray(block)
    first = list_entries(block, header, header.first)
    _set_numbers(buffer, header, first, size)
    for tag, kind, count, place in first:
        if tag == EXIF_IFD and kind in _FORMATS and count == 1:
            inner = read_number(Tag(4, 1, block[place : place + 4]), header.order)
            _set_numbers(buffer, header, list_entries(block, header, inner), size)
    _remove_thumbnail(buffer, header)
    added = _list_added({tag for tag, *_ in first}, header.order, line, dpi)
    return _add(bytes(buffer), header, added) if added else bytes(buffer)


def _set_numbers(
    buffer: bytearray,
    header: Header,
    entries: list[tuple[int, int, int, int]],
    size: tuple[int, int],
) -> None:
    wanted = {ORIENTATION: 1} | dict.fromkeys(_WIDTHS, size[0]) | dict.fromkeys(_HEIGHTS, size[1])
    for tag, kind, count, place in entries:
        if tag in wanted and kind in _FORMATS and count == 1:
            struct.pack_into(header.order + _FORMATS[kind], buffer, place, wanted[tag])


def _remove_thumbnail(buffer: bytearray, header: Header) -> None:
    count = struct.unpack_from(f"{header.order}H", buffer, header.first)[0]
    pointer = header.first + 2 + 12 * count
    if pointer + 4 > len(buffer):
        return
    second = struct.unpack_from(f"{header.order}I", buffer, pointer)[0]
    struct.pack_into(f"{header.order}I", buffer, pointer, 0)
    if not 0 < second < len(buffer):
        return
    try:
        entries = list_entries(buffer, header, second)
    except ValueError:
        return
    numbers = {
        tag: read_number(Tag(kind, 1, bytes(buffer[place : place + 4])), header.order)
        for tag, kind, amount, place in entries
        if amount == 1 and kind in _FORMATS
    }
    for start, length in _THUMBNAILS.items():
        place = numbers.get(start, 0)
        # A wrong offset must not wipe what is no thumbnail.
        if length in numbers and (buffer[place : place + 2] == b"\xff\xd8" or place > second):
            _blank(buffer, place, numbers[length])


def _blank(buffer: bytearray, start: int, length: int) -> None:
    """Remove bytes at the end of a block; inside of it, where others lie after them, zero them."""
    end = min(start + length, len(buffer))
    if end == len(buffer):
        del buffer[start:]
    else:
        buffer[start:end] = bytes(end - start)


def _list_added(
    present: set[int] | Directory, order: str, line: str, dpi: tuple[float, float] | None
) -> Directory:
    added: Directory = {PROCESSING_SOFTWARE: make_text(line)} if line else {}
    if dpi and _X_RESOLUTION not in present:
        added[_X_RESOLUTION] = make_rational(dpi[0], order)
        added[_Y_RESOLUTION] = make_rational(dpi[1], order)
        added[_RESOLUTION_UNIT] = make_short(_INCH, order)
    return added


def _add(block: bytes, header: Header, added: Directory) -> bytes:
    """Write the first directory again at the end, with more tags; the rest stays in its place."""
    order = header.order
    count = struct.unpack_from(f"{order}H", block, header.first)[0]
    entries: dict[int, bytes] = {}
    for number in range(count):
        place = header.first + 2 + 12 * number
        tag = struct.unpack_from(f"{order}H", block, place)[0]
        entries[tag] = block[place : place + 12]
    block += b"\0" * (len(block) % 2)
    start = len(block)
    tail_at = start + 2 + 12 * len(entries.keys() | added.keys()) + 4
    tail = b""
    for tag, item in added.items():
        assert isinstance(item, Tag)
        value = item.value
        if len(value) > 4:
            value = struct.pack(f"{order}I", tail_at + len(tail))
            tail += item.value + b"\0" * (len(item.value) % 2)
        head = struct.pack(f"{order}HHI", tag, item.kind, item.length)
        entries[tag] = head + value.ljust(4, b"\0")
    body = b"".join(entries[tag] for tag in sorted(entries))
    whole = block + struct.pack(f"{order}H", len(entries)) + body + b"\0" * 4 + tail
    return whole[:4] + struct.pack(f"{order}I", start) + whole[8:]
