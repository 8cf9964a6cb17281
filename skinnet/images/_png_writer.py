"""Writer of PNG files of 8 and 16 bits, with the chunks of the original."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from skinnet.images import _chunks as png
from skinnet.images._carried import Carried
from skinnet.images._writers import join_alpha
from skinnet.images.picture import Picture

_COLOUR = frozenset({b"iCCP", b"cICP", b"gAMA", b"cHRM", b"sRGB", b"mDCv", b"mDCV", b"cLLi"})
_ANEW = frozenset({b"IHDR", b"PLTE", b"tRNS", b"hIST", b"eXIf", b"acTL", b"fcTL", b"caBX"})
_OF_PIXELS = frozenset({b"bKGD", b"sBIT"})
"""Chunks in the pixels' own type, which a palette does not share with what is written."""

_XMP_KEYS = frozenset({"XML:com.adobe.xmp", "Raw profile type xmp"})
_RAW_EXIF = frozenset({"Raw profile type exif", "Raw profile type APP1"})
_RGB, _RGBA = 2, 6
_LEVEL = 1


def write_png_picture(path: Path, picture: Picture, carried: Carried) -> None:
    """Write a PNG file."""
    from imagecodecs import png_encode

    encoded = bytes(png_encode(join_alpha(picture), level=_LEVEL))
    path.write_bytes(png.insert_chunks(encoded, _list_chunks(picture, carried)))


def _list_chunks(picture: Picture, carried: Carried) -> list[png.Chunk]:
    own: list[png.Chunk] = list(carried.own.get("chunks", ()))
    kept = _keep(own, picture)
    names = {name for name, _ in kept}
    new: list[png.Chunk] = []
    if carried.profile and not names & {b"iCCP", b"cICP"} and not _states_colours(picture, names):
        kept = [chunk for chunk in kept if chunk[0] not in _COLOUR]
        new.append(png.make_profile(carried.profile))
    if carried.dpi and b"pHYs" not in names:
        new.append(png.make_resolution(carried.dpi))
    if carried.exif:
        new.append((b"eXIf", carried.exif))
    if carried.xmp:
        new.append(png.make_xmp(carried.xmp))
    keys = {png.read_key(chunk) for chunk in kept}
    if carried.comment and "Comment" not in keys:
        new.append(png.make_text("Comment", carried.comment.decode("utf-8", "replace")))
    return [*new, *_add_mark(kept, carried, keys)]


def _keep(own: list[png.Chunk], picture: Picture) -> list[png.Chunk]:
    head = dict(own).get(b"IHDR", b"")
    coloured = len(head) == 13 and head[9] in (_RGB, _RGBA)
    palette = len(head) == 13 and head[9] & 1
    dropped = _ANEW | (frozenset() if coloured else _OF_PIXELS)
    if not (coloured or palette):
        dropped |= _COLOUR
    elif picture.colour_space.known_from not in ("ICC profile", "cICP chunk"):
        dropped |= {b"iCCP"}  # it does not fit the pixels
    texts = _XMP_KEYS | _RAW_EXIF
    return [
        each
        for each in own
        if _may_be_copied(each[0]) and each[0] not in dropped and png.read_key(each) not in texts
    ]


def _may_be_copied(name: bytes) -> bool:
    """Whether the name of a chunk is four letters, of which the first says that it is optional."""
    return name.isalpha() and name[:1].islower()


def _states_colours(picture: Picture, names: set[bytes]) -> bool:
    known: Mapping[str, Any] = {"gAMA": b"gAMA", "cHRM": b"cHRM", "sRGB": b"sRGB"}
    words = picture.colour_space.known_from.split()
    return any(word in known for word in words) and names >= {known[w] for w in words if w in known}


def _add_mark(kept: list[png.Chunk], carried: Carried, keys: set[str]) -> list[png.Chunk]:
    """Texts with the mark; the name of the software that wrote the original stays."""
    if carried.mark is None:
        return kept
    texts = carried.mark.to_text()
    old = [chunk for chunk in kept if png.read_key(chunk) != "skinnet"]
    return [
        *old,
        *(png.make_text(key, texts[key]) for key in texts if key not in keys - {"skinnet"}),
    ]
