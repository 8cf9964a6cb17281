"""Writer of TIFF files of 8 and 16 bits, with the tags of the original."""

import struct
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

from skinnet.images._carried import Carried
from skinnet.images._directories import (
    Directory,
    Tag,
    read_directory,
    read_header,
    write_directory,
)
from skinnet.images._metadata import LAYOUT
from skinnet.images._writers import join_alpha
from skinnet.images.picture import Picture

_COMPRESSIONS: dict[int, str | None] = {
    1: None,
    5: "lzw",
    **dict.fromkeys((8, 32946), "zlib"),
    32773: "packbits",
    34925: "lzma",
    50000: "zstd",
}
_DEFLATE = 8
_XMP, _IPTC, _PHOTOSHOP = 700, 33723, 34377
_BYTE, _UNDEFINED = 1, 7


def write_tiff(path: Path, picture: Picture, carried: Carried) -> None:
    """Write a TIFF file, compressed as the original where that loses nothing."""
    from tifffile import imwrite

    order = read_header(carried.exif).order if carried.exif else "<"
    tags = _list_tags(carried, order)
    imwrite(
        path,
        join_alpha(picture),
        byteorder=">" if order == ">" else "<",
        photometric="separated" if picture.pixels.shape[2] == 4 else "rgb",
        planarconfig="contig",
        extrasamples=None if picture.alpha is None else ["unassalpha"],
        iccprofile=carried.profile or None,
        resolution=carried.dpi,
        resolutionunit="INCH" if carried.dpi else None,
        metadata=None,
        software=False,
        **_choose_compression(carried),
    )
    _add_tags(path, tags, order)


def _choose_compression(carried: Carried) -> dict[str, Any]:
    own = carried.own
    if "compression" not in own:
        return {"compression": "zlib", "predictor": True}
    name = _COMPRESSIONS.get(own["compression"], _COMPRESSIONS[_DEFLATE])
    predicted = name in ("lzw", "zlib", "zstd", "lzma") and bool(own.get("predictor"))
    return {"compression": name, "predictor": predicted or None}


def _list_tags(carried: Carried, order: str) -> Directory:
    tags: Directory = {}
    if carried.exif:
        header = read_header(carried.exif)
        found = read_directory(carried.exif, header)
        tags |= {tag: item for tag, item in found.items() if tag not in LAYOUT}
    for tag, kind, value in (
        (_XMP, _BYTE, carried.xmp),
        (_IPTC, _UNDEFINED, carried.own.get("iptc", b"")),
        (_PHOTOSHOP, _BYTE, carried.photoshop),
    ):
        if value:
            tags[tag] = Tag(kind, len(value), value)
    return tags


def _add_tags(path: Path, tags: Directory, order: str) -> None:
    """Write the first directory again at the end of the file, with more tags."""
    if not tags:
        return
    with path.open("r+b") as file:
        with mmap(file.fileno(), 0, access=ACCESS_READ) as data:
            own = read_directory(data, read_header(data[:16]))
        at = file.seek(0, 2)
        file.write(b"\0" * (at % 2))
        at += at % 2
        file.write(write_directory(own | tags, order, at))
        file.seek(4)
        file.write(struct.pack(f"{order}I", at))
