"""Chunks of PNG files."""

import struct
import zlib
from collections.abc import Iterable, Iterator

Chunk = tuple[bytes, bytes]
"""Name and content."""

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_XMP_KEY = b"XML:com.adobe.xmp"
_MAX_TEXT = 1 << 24


def list_chunks(data: bytes, ahead: bool = False) -> Iterator[Chunk]:
    """List all chunks of a PNG file but those of its pixels; `ahead` lists those before them."""
    at = len(SIGNATURE)
    while data.startswith(SIGNATURE) and at + 8 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        if ahead and name in (b"IDAT", b"IEND"):
            return
        if name not in (b"IDAT", b"fdAT", b"IEND"):
            yield name, data[at + 8 : at + 8 + length]
        at += 12 + length


def has_sound_pixels(data: bytes) -> bool:
    """Whether the chunks of a PNG file's pixels have the checksums that they state."""
    view, at = memoryview(data), len(SIGNATURE)
    while at + 12 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        end = at + 8 + length
        if name == b"IDAT" and end + 4 <= len(data):
            if zlib.crc32(view[at + 4 : end]) != struct.unpack_from(">I", data, end)[0]:
                return False
        at = end + 4
    return True


def insert_chunks(data: bytes, chunks: Iterable[Chunk]) -> bytes:
    """Insert chunks after the header of a PNG file, which has no others before its pixels."""
    head = len(SIGNATURE) + 25
    return b"".join((data[:head], *pack_chunks(chunks), data[head:]))


def pack_chunks(chunks: Iterable[Chunk]) -> Iterator[bytes]:
    """Pack chunks as a file holds them, in parts, so that a large content is not copied."""
    for name, body in chunks:
        yield struct.pack(">I", len(body)) + name
        yield body
        yield struct.pack(">I", zlib.crc32(body, zlib.crc32(name)))


def read_key(chunk: Chunk) -> str:
    """Read the keyword of a text chunk; "" of others."""
    if chunk[0] not in (b"tEXt", b"zTXt", b"iTXt"):
        return ""
    return chunk[1].partition(b"\0")[0].decode("latin-1")


def read_text(chunk: Chunk) -> bytes:
    """Read the text of a text chunk, in Latin-1 or, of iTXt, in UTF-8.

    Raises:
        ValueError: It cannot be unpacked, or is larger than 16 MB.
    """
    name, body = chunk
    text = body.partition(b"\0")[2]
    packed = name == b"zTXt"
    if name == b"iTXt":
        packed = text[:1] == b"\x01"
        text = text[2:].split(b"\0", 2)[-1]
    elif packed:
        text = text[1:]
    if not packed:
        return text
    try:
        return zlib.decompressobj().decompress(text, _MAX_TEXT)
    except zlib.error as error:
        raise ValueError("a text chunk is damaged") from error


def make_text(key: str, text: str) -> Chunk:
    """Make a text chunk: tEXt where Latin-1 holds the text, else iTXt."""
    try:
        return b"tEXt", key.encode("latin-1") + b"\0" + text.encode("latin-1")
    except UnicodeEncodeError:
        return b"iTXt", key.encode("latin-1", "replace") + b"\0\0\0\0\0" + text.encode()


def make_xmp(xmp: bytes) -> Chunk:
    """Make the chunk of an XMP packet."""
    return b"iTXt", _XMP_KEY + b"\0\0\0\0\0" + xmp


def make_profile(profile: bytes) -> Chunk:
    """Make the chunk of a colour profile."""
    return b"iCCP", b"ICC Profile\0\0" + zlib.compress(profile)


def make_resolution(dpi: tuple[float, float]) -> Chunk:
    """Make the chunk of a resolution."""
    x, y = (round(value / 0.0254) for value in dpi)
    return b"pHYs", struct.pack(">IIB", x, y, 1)


def decode_raw_profile(text: bytes) -> bytes:
    """Decode what ImageMagick writes as text "Raw profile type NAME".

    Raises:
        ValueError: It is damaged.
    """
    _, _, _, *lines = text.split(b"\n")
    return bytes.fromhex(b"".join(lines).decode("ascii"))
