"""What kind of file it is, by its first bytes; the ending of its name decides nothing."""

import re
from importlib.util import find_spec
from io import BufferedIOBase
from pathlib import Path
from typing import BinaryIO, NamedTuple

from skinnet.files import READ_ERRORS
from skinnet.images._tiff_structure import is_raw

_SAVE = "save it as JPEG, PNG or TIFF"


class Kind(NamedTuple):
    """A kind of files: its name for one and for many, and how to get a picture from one."""

    one: str
    many: str
    remedy: str = _SAVE


def _name_kind(one: str, remedy: str = _SAVE) -> Kind:
    return Kind(one, f"{one.partition(' ')[2]}s", remedy)


PICTURE = Kind("a picture", "pictures")
HEIF = _name_kind("a HEIC picture", 'pip install "skinnet[heif]" reads it; or save it as JPEG')
RAW = _name_kind(
    "a RAW file",
    'pip install "skinnet[raw]" reads it; or develop it, and save it as 16-bit TIFF or JPEG',
)
OTHER = Kind("another file", "other files", "give a JPEG, PNG, TIFF or WebP file")
EMPTY = Kind("an empty file", "empty files", "was it copied completely?")
THUMBNAIL = _name_kind("a camera's thumbnail", "give the picture itself, or rename this to .jpg")
_POINTER = _name_kind("a Git LFS pointer", "fetch the picture itself with git lfs pull")
_PAGE = Kind("a web page (HTML)", "web pages", "download the picture itself")
_VIDEO = _name_kind("a video", "save one of its frames as PNG")
_SOUND = Kind("a sound file", "sound files")
_JXL = _name_kind("a JPEG XL picture")
_PHOTOSHOP = _name_kind("a Photoshop file", "export it as PNG, TIFF or JPEG")
_SVG = _name_kind("an SVG drawing", "a photograph has pixels; give that")
_PDF = _name_kind("a PDF file", "save its picture as PNG, TIFF or JPEG")

HEIF_SUFFIXES = frozenset(".heic .heif .hif .heics .heifs".split())
_PICTURE_SUFFIXES = frozenset(
    (
        ".jpg .jpeg .jpe .jfif .jfi .jif .pjpeg .pjp .mpo .png .apng .tif .tiff .webp .avif .avifs "
        ".jp2 .j2k .j2c .jpc .jpf .jpx .bmp .dib .gif .ppm .pgm .pbm .pnm"
    ).split()
)
_RAW_SUFFIXES = frozenset(
    (
        ".3fr .arw .bay .cap .cr2 .cr3 .crw .dcr .dng .erf .fff .gpr .iiq .k25 .kdc .mdc .mef .mos "
        ".mrw .nef .nrw .orf .ori .pef .ptx .raf .raw .rw2 .rwl .rwz .sr2 .srf .srw .x3f"
    ).split()
)
_THUMBNAIL_SUFFIXES = frozenset({".thm"})

_HEAD = 4096
_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_HEIF_BRANDS = frozenset(b"heic heix heim heis hevc hevx hevm hevs mif1 msf1".split())
_AVIF_BRANDS = frozenset(b"avif avis".split())
_PNM = re.compile(rb"P[1-6](?:(?:\s|#[^\n\r]*[\n\r])+\d+){2}\s")
_BMP = re.compile(rb"BM.{12}[\x0c\x10\x28\x34\x38\x40\x6c\x7c]\0\0\0", re.DOTALL)

_STARTS: tuple[tuple[bytes, Kind], ...] = (
    *((start, PICTURE) for start in (b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"GIF87a", b"GIF89a")),
    *((start, PICTURE) for start in (b"\0\0\0\x0cjP  \r\n\x87\n", b"\xff\x4f\xff\x51")),
    *((start, RAW) for start in (b"IIRO", b"IIRS", b"MMOR", b"MMRO", b"IIU\0", b"FUJIFILMCCD-RAW")),
    *((start, RAW) for start in (b"FOVb", b"\0MRM", b"II\x1a\0\0\0HEAP", b"MM\0\x1a\0\0\0HEAP")),
    *((start, _JXL) for start in (b"\xff\x0a", b"\0\0\0\x0cJXL \r\n\x87\n")),
    *(
        (start, _VIDEO)
        for start in (b"\x1aE\xdf\xa3", b"\0\0\x01\xba", b"\0\0\x01\xb3", b"FLV\x01")
    ),
    *((start, _VIDEO) for start in (b"0&\xb2u\x8ef\xcf\x11", b"\x8aMNG\r\n\x1a\n")),
    *((start, _SOUND) for start in (b"ID3", b"fLaC", b"OggS")),
    (b"8BPS", _PHOTOSHOP),
    (b"gimp xcf", _name_kind("a GIMP file", "export it as PNG, TIFF or JPEG")),
    (b"%PDF-", _PDF),
    (b"%!PS", _name_kind("a PostScript file")),
    (b"\xc5\xd0\xd3\xc6", _name_kind("a PostScript file")),
    (b"II\xbc\x01", _name_kind("a JPEG XR picture")),
    (b"v/1\x01", _name_kind("an OpenEXR picture")),
    (b"#?RADIANCE", _name_kind("a Radiance picture")),
    (b"#?RGBE", _name_kind("a Radiance picture")),
    (b"DDS ", _name_kind("a DirectDraw texture")),
    (b"\xabKTX", _name_kind("a KTX texture")),
    (b"qoif", _name_kind("a QOI picture")),
    (b"BPG\xfb", _name_kind("a BPG picture")),
    (b"FLIF", _name_kind("a FLIF picture")),
    (b"\0\0\x01\0", _name_kind("a Windows icon")),
    (b"\0\0\x02\0", _name_kind("a Windows cursor")),
    (b"icns", _name_kind("a macOS icon")),
    (b"SIMPLE  =", _name_kind("a FITS file")),
    (b"AT&TFORM", _name_kind("a DjVu file")),
    (
        b"\0\x05\x16\x07",
        _name_kind("an AppleDouble file", "it holds no pixels; give its other half"),
    ),
    (b"version https://git-lfs", _POINTER),
    (b"PK\x03\x04", _name_kind("a ZIP archive", "unpack it")),
)


def identify(file: BinaryIO | BufferedIOBase, name: str = "") -> Kind:
    """Identify an open file by its content.

    Args:
        file: It is left at any place.
        name: Its name, whose ending only makes known what the content leaves open: the RAW file of
            a camera that is written as a TIFF file.

    Returns:
        `PICTURE` for all that is read without an extra.
    """
    file.seek(0)
    head = file.read(_HEAD)
    suffix = Path(name).suffix.lower()
    if not head:
        return EMPTY
    if head.startswith(_TIFF):
        return RAW if suffix in _RAW_SUFFIXES or _is_raw(file) else PICTURE
    kind = _identify_start(head)
    if kind is OTHER and suffix in _RAW_SUFFIXES:
        return RAW
    return THUMBNAIL if kind is PICTURE and suffix in _THUMBNAIL_SUFFIXES else kind


def is_readable(kind: Kind) -> bool:
    """Whether files of a kind can be read here."""
    extra = {HEIF: "pillow_heif", RAW: "rawpy"}.get(kind)
    return kind is PICTURE or (extra is not None and find_spec(extra) is not None)


def promises_picture(name: str, kind: Kind) -> bool:
    """Whether the ending promises a picture of another kind than the file is, as a.jpg of HTML."""
    found = re.match(r"\.[a-z0-9]+", Path(name).suffix.lower())  # .jpg_large and others too
    suffix = found.group() if found else ""
    return suffix in _PICTURE_SUFFIXES or (suffix in HEIF_SUFFIXES and kind is not HEIF)


def has_picture_ending(name: str) -> bool:
    """Whether a name ends as those of pictures, HEIF and RAW files do."""
    suffix = Path(name).suffix.lower()
    return suffix in _PICTURE_SUFFIXES | HEIF_SUFFIXES | _RAW_SUFFIXES


def is_heif(data: bytes) -> bool:
    """Whether the first bytes of a file are those of a HEIC or HEIF picture."""
    return _identify_start(data[:_HEAD]) is HEIF


def _is_raw(file: BinaryIO | BufferedIOBase) -> bool:
    try:
        return is_raw(file)
    except READ_ERRORS:  # damaged directories; reading it says so
        return False


def _identify_start(head: bytes) -> Kind:
    for start, kind in _STARTS:
        if head.startswith(start):
            return kind
    if head[4:8] in (b"ftyp", b"moov", b"mdat", b"wide", b"pnot", b"skip"):
        return _identify_brands(head)
    if head.startswith(b"RIFF"):
        return {b"WEBP": PICTURE, b"WAVE": _SOUND}.get(head[8:12], _VIDEO)
    if _BMP.match(head) or _PNM.match(head):
        return PICTURE
    if head[128:132] == b"DICM":
        return _name_kind("a DICOM file", "export it as PNG or TIFF")
    if head[:1] == b"G" and head[188:189] == b"G" and head[376:377] == b"G":
        return _VIDEO
    return _identify_text(head)


def _identify_brands(head: bytes) -> Kind:
    """Kinds of the ISO base media file format, by the brands in its first box."""
    length = min(int.from_bytes(head[:4], "big"), len(head))
    brands = {head[8:12], *(head[at : at + 4] for at in range(16, length, 4))}
    if head[4:8] != b"ftyp":
        return _VIDEO
    if b"crx " in brands:
        return RAW
    if _AVIF_BRANDS & brands:
        return PICTURE
    if _HEIF_BRANDS & brands:
        return HEIF
    return _SOUND if head[8:11] == b"M4A" else _VIDEO


def _identify_text(head: bytes) -> Kind:
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    if text.startswith(b"<"):
        if b"<svg" in text:
            return _SVG if not text.startswith((b"<!doctype html", b"<html")) else _PAGE
        return _PAGE if b"<html" in text or text.startswith(b"<!doctype html") else OTHER
    return _PDF if b"%pdf-" in text[:1024] else OTHER
