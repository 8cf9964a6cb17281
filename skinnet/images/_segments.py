"""Segments of JPEG files."""

import struct
from collections.abc import Iterator

APP0, EXIF_OR_XMP, ICC_OR_MPF, JUMBF, PHOTOSHOP, ADOBE, COMMENT = (
    *(0xE0, 0xE1, 0xE2, 0xEB, 0xED, 0xEE),
    0xFE,
)
EXIF_PREFIX, XMP_PREFIX = b"Exif\0\0", b"http://ns.adobe.com/xap/1.0/\0"
ICC_PREFIX, PHOTOSHOP_PREFIX = b"ICC_PROFILE\0", b"Photoshop 3.0\0"
MPF_PREFIX, GAIN_MAP_PREFIX = b"MPF\0", b"urn:iso:std:iso:ts:21496:-1\0"
JFIF_PREFIX, CREDENTIALS_PREFIX = b"JFIF\0", b"JP"

LARGEST = 65533
"""Bytes that a segment can hold."""

_SOI, _SOS, _ALONE = 0xD8, 0xDA, frozenset({0x01, *range(0xD0, 0xD8)})
_ICC_PART = LARGEST - 14

Segment = tuple[int, bytes]
"""The marker's second byte, and the content."""


def list_segments(data: bytes) -> Iterator[Segment]:
    """List the segments of applications and the comments before the pixels of a JPEG file."""
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] != _SOS:
        marker = data[at + 1]
        if marker == 0xFF or marker in _ALONE:
            at += 1 if marker == 0xFF else 2
            continue
        length = struct.unpack_from(">H", data, at + 2)[0]
        if 0xE0 <= marker <= 0xEF or marker == COMMENT:
            yield marker, data[at + 4 : at + 2 + length]
        at += 2 + length


def replace_segments(data: bytes, segments: list[Segment]) -> bytes:
    """Replace those segments of a JPEG file by others; one of Adobe, on the pixels, stays."""
    at, kept = 2, []
    while data[at + 1] != _SOS:
        length = struct.unpack_from(">H", data, at + 2)[0]
        marker, end = data[at + 1], at + 2 + length
        if not (0xE0 <= marker <= 0xEF or marker == COMMENT) or marker == ADOBE:
            kept.append(data[at:end])
        at = end
    new = (
        bytes([0xFF, marker]) + struct.pack(">H", len(content) + 2) + content
        for marker, content in segments
    )
    return b"".join((bytes([0xFF, _SOI]), *new, *kept, data[at:]))


def split_profile(profile: bytes) -> list[Segment]:
    """Split a colour profile into segments."""
    parts = [profile[at : at + _ICC_PART] for at in range(0, len(profile), _ICC_PART)]
    return [
        (ICC_OR_MPF, ICC_PREFIX + bytes([number, len(parts)]) + part)
        for number, part in enumerate(parts, 1)
    ]


def split_resources(resources: bytes) -> list[Segment]:
    """Split Photoshop's image resources into segments."""
    size = LARGEST - len(PHOTOSHOP_PREFIX)
    return [
        (PHOTOSHOP, PHOTOSHOP_PREFIX + resources[at : at + size])
        for at in range(0, len(resources), size)
    ]


def is_plain(segment: Segment) -> bool:
    """Whether a segment stays as it is: not one that is written anew or that an edit makes untrue.

    These are EXIF, XMP, profiles, thumbnails, lists of pictures behind the first, and signatures.
    """
    marker, content = segment
    starts = {
        APP0: (JFIF_PREFIX, b"JFXX\0"),
        EXIF_OR_XMP: (EXIF_PREFIX, XMP_PREFIX),
        ICC_OR_MPF: (ICC_PREFIX, MPF_PREFIX, GAIN_MAP_PREFIX),
        JUMBF: (CREDENTIALS_PREFIX,),
        PHOTOSHOP: (PHOTOSHOP_PREFIX,),
        ADOBE: (b"",),
    }
    return not content.startswith(starts.get(marker, ()))
