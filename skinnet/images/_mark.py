"""The mark that every result carries, so that no result is taken for a photograph."""

import json
import os
import re
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from io import BufferedIOBase, BytesIO
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from PIL import Image, PngImagePlugin

from skinnet._version import __version__
from skinnet.files import READ_ERRORS
from skinnet.files._reading import read_file
from skinnet.images._chunks import SIGNATURE
from skinnet.images._decode import PHOTO_FORMATS
from skinnet.images._kind import is_heif
from skinnet.images._silence import silence_libraries

PROCESSING_SOFTWARE = 0x000B
"""EXIF tag that holds the line of an edited photograph's mark."""

EDITED = "edited"
"""Part of the mark of a photograph that `skinnet edit` wrote."""

_SOFTWARE = 0x0131
_LINE = re.compile(r"skinnet (\S+) ([\w-]+) ([\w-]+)(?: sha256:([0-9a-f]{64}))?")
_OLD_MAP = frozenset({"map", "scale", "offset", "unit"})
_SUMMARIES = (
    frozenset({"maps", "light", "camera", "skin_share"}),
    frozenset({"shots", "pigments", "shared_correlation"}),
)
"""Keys of the summaries of a photograph and of a person."""

_SCAN_PICTURES = {
    "shape": ("_shape.npz",),
    **dict.fromkeys(("panel", "albedo", "render", "face"), ("_maps.npz",)),
}
"""Pictures of scans by the end of their names, and the archives that lie beside them."""

_TAIL, _LONGEST_TEXT, _LARGEST_SUMMARY = 256, 4096, 1_000_000
_Source = str | Path | BinaryIO | BufferedIOBase


class Mark(NamedTuple):
    """What a result says of itself.

    Attributes:
        verb: The verb that wrote it, such as `predict`.
        part: What it shows: `map`, `panel`, `reconstruction`, `edited` or another word.
        digest: SHA-256 of the file that it was made from, in hexadecimals; empty if not known.
        version: The version of skinnet that wrote it; empty for versions without marks.
    """

    verb: str
    part: str
    digest: str = ""
    version: str = __version__

    def __str__(self) -> str:
        """Return the mark as one line of ASCII, for EXIF's ProcessingSoftware."""
        line = f"skinnet {self.version} {self.verb} {self.part}"
        return f"{line} sha256:{self.digest}" if self.digest else line

    def to_text(self) -> dict[str, str]:
        """Return the mark as tEXt chunks of a PNG file, for `write_png`."""
        return {"Software": f"skinnet {self.version}", "skinnet": str(self)}

    def to_png_info(self) -> PngImagePlugin.PngInfo:
        """Return the mark as Pillow's `pnginfo`."""
        info = PngImagePlugin.PngInfo()
        for key, value in self.to_text().items():
            info.add_text(key, value)
        return info


def append_mark(path: Path, mark: Mark) -> None:
    """Append a mark to a file whose format holds neither text nor EXIF (BMP, PPM, GIF)."""
    with path.open("ab") as file:
        file.write(f"\n{mark}\n".encode("ascii"))


def read_mark(source: _Source) -> Mark | None:
    """Read the mark of a picture file, also that of a result from before there were marks.

    Args:
        source: A path, or an open binary file, whose position is kept.

    Returns:
        The mark; None if the file carries none or cannot be read.
    """
    silence_libraries()
    with warnings.catch_warnings(), suppress(*READ_ERRORS):
        warnings.simplefilter("ignore")  # of damaged metadata
        if not isinstance(source, str | Path):
            return _read_and_rewind(source)
        if not Path(source).is_file():  # a pipe would wait for its writer
            return None
        with open(source, "rb") as file:
            return _read_open(file) or _read_neighbour(Path(source))
    return None


def read_summary(path: Path) -> dict[str, Any] | None:
    """Read a JSON file if it is a summary of a photograph or a person, of any version."""
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST_SUMMARY:
            return None
        summary = json.loads(read_file(path))
    except READ_ERRORS:
        return None
    if not isinstance(summary, dict):
        return None
    return summary if any(summary.keys() >= keys for keys in _SUMMARIES) else None


def parse_mark(line: object) -> Mark | None:
    """Parse the line of a mark; None if it is another text."""
    text = line.decode("latin-1") if isinstance(line, bytes) else line
    found = _LINE.match(text) if isinstance(text, str) else None
    if found is None:
        return None
    version, verb, part, digest = found.groups()
    return Mark(verb, part, digest or "", version)


def _read_and_rewind(file: BinaryIO | BufferedIOBase) -> Mark | None:
    place = file.tell()
    try:
        return _read_open(file)
    finally:
        file.seek(place)


def _read_open(file: BinaryIO | BufferedIOBase) -> Mark | None:
    file.seek(0)
    if file.read(8) == SIGNATURE:
        return _read_png(file)
    return _read_exif(file) or _read_tail(file)


def _read_png(file: BinaryIO | BufferedIOBase) -> Mark | None:
    texts: dict[str, str] = {}
    for name, body in _list_chunks(file):
        if name == b"eXIf":
            exif = Image.Exif()
            exif.load(b"Exif\0\0" + body)
            if mark := _find_line(exif):
                return mark
        keyword, _, text = body.partition(b"\0")
        texts[keyword.decode("latin-1")] = _decode_text(name, text).decode("utf-8", "replace")
    software = texts.get("Software", "")
    if mark := parse_mark(texts.get("skinnet")) or parse_mark(software):
        return mark
    if software.startswith("skinnet "):
        return Mark("", "result", "", software.split()[1])
    return Mark("predict", "map", "", "") if texts.keys() >= _OLD_MAP else None


def _decode_text(name: bytes, text: bytes) -> bytes:
    """The text of a chunk; other programs may have compressed it or stated its language."""
    if name == b"zTXt":
        return _decompress(text[1:])
    if name == b"iTXt":
        compressed, (_, _, rest) = text[:1] == b"\1", text[2:].split(b"\0", 2)
        return _decompress(rest) if compressed else rest
    return text


def _decompress(data: bytes) -> bytes:
    return zlib.decompressobj().decompress(data, _LONGEST_TEXT)


def _list_chunks(file: BinaryIO | BufferedIOBase) -> Iterator[tuple[bytes, bytes]]:
    """The text and EXIF chunks of a PNG file, which may stand on both sides of its pixels."""
    file.seek(len(SIGNATURE))
    while len(head := file.read(8)) == 8 and head[4:] != b"IEND":
        length, name = struct.unpack(">I4s", head)
        if name in (b"tEXt", b"zTXt", b"iTXt", b"eXIf"):
            yield name, file.read(length)
            length = 0
        file.seek(length + 4, os.SEEK_CUR)


def _read_exif(file: BinaryIO | BufferedIOBase) -> Mark | None:
    file.seek(0)
    if is_heif(file.read(64)):
        return _read_heif(file)
    file.seek(0)
    Image.init()
    formats = [known for known in PHOTO_FORMATS if known in Image.OPEN]
    try:
        image = Image.open(file, formats=formats)  # type: ignore[arg-type]
        return _find_line(image.getexif()) or parse_mark(image.info.get("comment"))
    except (Image.DecompressionBombError, *READ_ERRORS):
        return None


def _read_heif(file: BinaryIO | BufferedIOBase) -> Mark | None:
    if find_spec("pillow_heif") is None:
        return None
    import pillow_heif

    file.seek(0)
    exif = Image.Exif()
    exif.load(pillow_heif.open_heif(BytesIO(file.read())).info.get("exif") or b"")
    return _find_line(exif)


def _find_line(exif: Image.Exif) -> Mark | None:
    return parse_mark(exif.get(PROCESSING_SOFTWARE)) or parse_mark(exif.get(_SOFTWARE))


def _read_tail(file: BinaryIO | BufferedIOBase) -> Mark | None:
    size = file.seek(0, os.SEEK_END)
    file.seek(max(0, size - _TAIL))
    last = file.read().rstrip(b"\n").rpartition(b"\n")[2]
    return parse_mark(last)


def _read_neighbour(path: Path) -> Mark | None:
    """The mark of a panel or a reconstruction that only the summary beside it makes known."""
    stem, _, part = path.stem.rpartition("_")
    if not stem or path.suffix != ".png":
        return None
    if part in ("panel", "reconstruction") and read_summary(path.with_name(f"{stem}.json")):
        return Mark("predict", part, "", "")
    ends = _SCAN_PICTURES.get(part, ())
    scan = any(path.with_name(stem + end).is_file() for end in ends)
    return Mark("maps", part, "", "") if scan else None
