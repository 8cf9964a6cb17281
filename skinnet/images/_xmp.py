"""XMP of an edited photograph: as it was, apart from what the edit makes untrue."""

import re

GAIN_MAP, MOTION = "gain map", "video of a motion photograph"

_LEFT_OUT = {
    GAIN_MAP: rb"""\s(?:hdrgm|HDRGainMap|hdr_metadata):\w+=("[^"]*"|'[^']*')"""
    rb"""|<((?:hdrgm|HDRGainMap):\w+)\b[^>]*(?:/>|>.*?</\2\s*>)""",
    MOTION: rb"""\s(?:GCamera|Camera):(?:MotionPhoto|MicroVideo)\w*=("[^"]*"|'[^']*')"""
    rb"""|<((?:GCamera|Camera):(?:MotionPhoto|MicroVideo)\w*)\b[^>]*(?:/>|>.*?</\2\s*>)""",
}
"""Statements on pictures and videos that lie behind the picture in its file."""

_PARTS = rb"<(\w+:Thumbnails|(?:Container|GContainer):Directory)\b[^>]*(?:/>|>.*?</\1\s*>)"
"""Thumbnails, which show the photograph before the edit, and the list of what a file holds."""


def find_companions(xmp: bytes) -> tuple[str, ...]:
    """Find what XMP says that lies behind the picture in its file."""
    return tuple(name for name, words in _LEFT_OUT.items() if re.search(words, xmp, re.DOTALL))


def update_xmp(xmp: bytes, size: tuple[int, int]) -> bytes:
    """Update the XMP of a picture that has been edited and turned upright.

    Orientation becomes 1, sizes in pixels are those of the picture; thumbnails, and statements on
    gain maps and videos, are removed.

    Args:
        xmp: The packet, in UTF-8; others are returned as they are.
        size: Width and height of the picture.
    """
    xmp = re.sub(_PARTS, b"", xmp, flags=re.DOTALL)
    for words in _LEFT_OUT.values():
        xmp = re.sub(words, b"", xmp, flags=re.DOTALL)
    numbers = {
        rb"tiff:Orientation": 1,
        rb"(?:tiff:ImageWidth|exif:PixelXDimension)": size[0],
        rb"(?:tiff:ImageLength|exif:PixelYDimension)": size[1],
    }
    for name, number in numbers.items():
        new = rb"\g<1>%d" % number
        xmp = re.sub(rb"""(\b%s\s*=\s*["'])\s*\d+""" % name, new, xmp)
        xmp = re.sub(rb"(<%s\s*>)\s*\d+" % name, new, xmp)
    return xmp
