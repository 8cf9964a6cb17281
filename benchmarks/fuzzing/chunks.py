"""Changes of the parts of container formats; lengths and checksums fit."""

import struct
import zlib
from collections.abc import Callable
from random import Random

from benchmarks.fuzzing.changes import change_bytes

Parts = list[tuple[bytes, bytes]]
"""Parts of a file: the name or the marker of each, and its content."""


def change_png(data: bytes, rng: Random) -> bytes:
    """Change chunks of a PNG file; their lengths and checksums fit."""
    head, parts, at = data[:8], [], 8
    while at + 8 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        parts.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    return head + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in change_parts(parts, rng, _change_png_body)
    )


def change_jpeg(data: bytes, rng: Random) -> bytes:
    """Change segments of a JPEG file before its pixels; their lengths fit."""
    parts, at = [], 2
    while at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] != 0xDA:
        (length,) = struct.unpack_from(">H", data, at + 2)
        parts.append((data[at : at + 2], data[at + 4 : at + 2 + length]))
        at += 2 + length
    changed = change_parts(parts, rng, change_bytes)
    joined = b"".join(
        marker + struct.pack(">H", min(len(body) + 2, 0xFFFF)) + body[:0xFFFD]
        for marker, body in changed
    )
    return data[:2] + joined + data[at:]


def change_riff(data: bytes, rng: Random) -> bytes:
    """Change chunks of a WebP file; their lengths fit."""
    parts, at = [], 12
    while at + 8 <= len(data):
        (length,) = struct.unpack_from("<I", data, at + 4)
        parts.append((data[at : at + 4], data[at + 8 : at + 8 + length]))
        at += 8 + length + length % 2
    body = b"".join(
        name + struct.pack("<I", len(each)) + each + b"\0" * (len(each) % 2)
        for name, each in change_parts(parts, rng, change_bytes)
    )
    return b"RIFF" + struct.pack("<I", len(body) + 4) + data[8:12] + body


def change_boxes(data: bytes, rng: Random) -> bytes:
    """Change boxes of a HEIF, AVIF or JPEG 2000 file; their own lengths fit."""
    parts, at = [], 0
    while at + 8 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        length = length if length >= 8 else len(data) - at
        parts.append((data[at + 4 : at + 8], data[at + 8 : at + length]))
        at += length
    return b"".join(
        struct.pack(">I", len(body) + 8) + name + body
        for name, body in change_parts(parts, rng, change_bytes)
    )


def change_directories(data: bytes, rng: Random) -> bytes:
    """Change entries of the directories of a TIFF file: tags, types, counts and values."""
    order = "<" if data[:2] == b"II" else ">"
    changed = bytearray(data)
    (first,) = struct.unpack_from(f"{order}I", data, 4)
    if first + 2 > len(data) or data[2:4] not in (b"*\0", b"\0*"):
        return change_bytes(data, rng)
    (count,) = struct.unpack_from(f"{order}H", data, first)
    for _ in range(rng.choice((1, 1, 2, 3))):
        entry = first + 2 + 12 * rng.randrange(max(count, 1))
        if entry + 12 > len(data):
            continue
        match rng.randrange(5):
            case 0:
                struct.pack_into(f"{order}H", changed, entry, rng.choice(_TAGS))
            case 1:
                struct.pack_into(f"{order}H", changed, entry + 2, rng.randrange(19))
            case 2:
                struct.pack_into(f"{order}I", changed, entry + 4, rng.choice(_EXTREMES))
            case 3:
                struct.pack_into(f"{order}H", changed, entry + 8, rng.randrange(65536))
            case _:
                struct.pack_into(f"{order}I", changed, entry + 8, rng.choice((*_EXTREMES, first)))
    return bytes(changed)


def change_parts(parts: Parts, rng: Random, change: Callable[[bytes, Random], bytes]) -> Parts:
    """Change parts of a file: the content of one, their order and their number."""
    parts = list(parts)
    for _ in range(rng.choice((1, 1, 2)) if parts else 0):
        at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
        name, body = parts[at]
        match rng.randrange(9):
            case 0:
                parts.insert(other, parts[at])
            case 1 if len(parts) > 1:
                del parts[at]
            case 2:
                parts[at], parts[other] = parts[other], parts[at]
            case 3:
                parts[at] = (name, parts[other][1])
            case 4:
                parts[at] = (parts[other][0], body)
            case _:
                parts[at] = (name, change(body, rng))
    return parts


def _change_png_body(body: bytes, rng: Random) -> bytes:
    """Change the content of a chunk, also under its compression."""
    for start in (0, body.find(b"\0") + 2):
        try:
            plain = zlib.decompress(body[start:])
        except zlib.error:
            continue
        if rng.random() < 0.6:
            return body[:start] + zlib.compress(change_bytes(plain, rng))
    return change_bytes(body, rng)


_TAGS = (
    *(254, 256, 257, 258, 259, 262, 273, 274, 277, 278, 279, 282, 284, 317, 320, 322, 323),
    *(324, 330, 338, 339, 34665, 34675, 34853, 50706, 700, 33723),
)
_EXTREMES = (0, 1, 2, 3, 8, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1, 100_000, 10_000)
