"""Small files of kinds that are no pictures to read, by the name of their kind."""

import struct

import numpy as np
import tifffile

HTML = b"<!DOCTYPE html>\n<html><head><title>404</title></head></html>"
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"
SVG = b'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg"></svg>'


def box(brand: bytes, *compatible: bytes) -> bytes:
    """A file of the ISO base media file format that begins with its brands."""
    body = brand + bytes(4) + b"".join(compatible)
    return struct.pack(">I", 8 + len(body)) + b"ftyp" + body + struct.pack(">I", 8) + b"mdat"


def tiff(entries: list[tuple[int, int, int]], order: str = "<", sub: bool = False) -> bytes:
    """A TIFF file of LONG tags; `sub` puts them into a SubIFD behind a preview's directory."""
    head = struct.pack(order + "2sHI", b"II" if order == "<" else b"MM", 42, 8)
    if not sub:
        return head + directory(entries, order)
    first = [(254, 4, 1), (256, 4, 16), (257, 4, 16), (262, 4, 2), (330, 4, 0)]
    size = len(directory(first, order))
    first[-1] = (330, 4, 8 + size)
    return head + directory(first, order) + directory(entries, order)


def directory(entries: list[tuple[int, int, int]], order: str) -> bytes:
    packed = b"".join(
        struct.pack(order + "HHII", tag, type_, 1, value) for tag, type_, value in entries
    )
    return struct.pack(order + "H", len(entries)) + packed + bytes(4)


def _sensor(compression: int = 1) -> list[tuple[int, int, int]]:
    return [(256, 4, 16), (257, 4, 16), (259, 4, compression), (262, 4, 32803)]


RAW = {
    "a.dng": tiff([(262, 4, 2), (50706, 4, 0x00000401)]),
    "big-endian.dng": tiff([(262, 4, 2), (50706, 4, 0x01040000)], ">"),
    "a.nef": tiff(_sensor(34713), ">", sub=True),
    "a.arw": tiff(_sensor(32767), sub=True),
    "a.pef": tiff(_sensor(65535)),
    "a.srw": tiff(_sensor(32770), sub=True),
    "a.cr2": b"II*\0\x10\0\0\0CR\x02\0" + bytes(30),
    "a.cr3": box(b"crx ", b"isom"),
    "a.crw": b"II\x1a\0\0\0HEAPCCDR" + bytes(30),
    "a.raf": b"FUJIFILMCCD-RAW 0201" + bytes(30),
    "a.orf": b"IIRO\x08\0\0\0" + bytes(30),
    "olympus.orf": b"IIRS\x08\0\0\0" + bytes(30),
    "a.rw2": b"IIU\0\x18\0\0\0" + bytes(30),
    "a.x3f": b"FOVb" + bytes(30),
    "a.mrw": b"\0MRM" + bytes(30),
    "a.iiq": b"II*\0\x08\0\0\0IIII" + bytes(30),
    "a.3fr": tiff(_sensor(), sub=True),
    "plain.nef": tiff([(256, 4, 16), (262, 4, 2)]),
    "unknown.arw": b"something else",
    "no_ending_nef": tiff(_sensor(34713), sub=True),
    "no_ending_dng": tiff([(262, 4, 2), (50706, 4, 0x00000401)]),
}
"""The beginnings of RAW files as cameras write them."""

KINDS = {
    "RAW file": RAW,
    "HEIC picture": {
        "a.heic": box(b"heic", b"mif1", b"heic"),
        "a.heif": box(b"mif1", b"mif1", b"heic"),
        "a.hif": box(b"heix", b"mif1"),
        "no_ending_heic": box(b"mif1", b"heic"),
    },
    "JPEG XL picture": {"a.jxl": b"\xff\x0a" + bytes(30), "b": b"\0\0\0\x0cJXL \r\n\x87\n"},
    "Photoshop file": {"a.psd": b"8BPS\0\x01" + bytes(30), "a.psb": b"8BPS\0\x02" + bytes(30)},
    "GIMP file": {"a.xcf": b"gimp xcf v011\0"},
    "SVG drawing": {"a.svg": SVG, "b.xml": b"\xef\xbb\xbf  <svg></svg>"},
    "PDF file": {"a.pdf": b"%PDF-1.7\n", "a.ai": b"%PDF-1.5\n"},
    "PostScript file": {"a.eps": b"%!PS-Adobe-3.0 EPSF-3.0\n"},
    "video": {
        "a.mp4": box(b"isom", b"iso2", b"avc1", b"mp41"),
        "a.mov": box(b"qt  ", b"qt  "),
        "old.mov": b"\0\0\0\x20moov" + bytes(30),
        "wide.mov": b"\0\0\0\x08wide\0\0\0\0mdat",
        "a.3gp": box(b"3gp4", b"isom"),
        "a.m4v": box(b"M4V ", b"M4V "),
        "a.mkv": b"\x1aE\xdf\xa3" + bytes(30),
        "a.avi": b"RIFF\0\0\0\0AVI LIST",
        "a.mpg": b"\0\0\x01\xba" + bytes(30),
        "a.wmv": b"0&\xb2u\x8ef\xcf\x11" + bytes(30),
        "a.flv": b"FLV\x01" + bytes(30),
        "a.ts": (b"G" + bytes(187)) * 3,
    },
    "sound file": {"a.m4a": box(b"M4A "), "a.mp3": b"ID3\x03", "a.wav": b"RIFF\0\0\0\0WAVE"},
    "OpenEXR picture": {"a.exr": b"v/1\x01" + bytes(30)},
    "Radiance picture": {"a.hdr": b"#?RADIANCE\n"},
    "Windows icon": {"a.ico": b"\0\0\x01\0\x01\0" + bytes(30)},
    "DICOM file": {"a.dcm": bytes(128) + b"DICM"},
    "Git LFS pointer": {"pointer": POINTER},
    "web page": {"a.html": HTML},
    "ZIP archive": {"a.zip": b"PK\x03\x04" + bytes(30), "a.kra": b"PK\x03\x04" + bytes(30)},
    "other file": {
        "a.json": b'{"a": 1}',
        "a.txt": b"BMW drives P6 report",
        "a.csv": b"P5 is a name, 3\n",
        "a.xmp": b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>",
        "a.aae": b"<?xml version='1.0'?><plist></plist>",
        "a.npy": b"\x93NUMPY",
        "a.bin": bytes(range(200)),
    },
    "empty file": {"a": b"", "b.dat": b""},
    "AppleDouble file": {"double": b"\0\x05\x16\x07\0\x02\0\0"},
}

NO_PICTURES = {
    "empty.jpg": b"",
    "empty.heic": b"",
    "page.jpg": HTML,
    "page.heic": HTML,
    "text.png": b"404: Not Found",
    "json.jpeg": b'{"error": "forbidden"}',
    "pointer.jpg": POINTER,
    "pointer.tif": POINTER,
    "video.jpg": box(b"isom", b"mp41"),
    "drawing.png": SVG,
    "document.jpg": b"%PDF-1.4\n",
    "layers.jpg": b"8BPS\0\x01" + bytes(30),
    "raw.tif": tiff([(262, 4, 2), (50706, 4, 0x00000401)]),
    "zeros.jpg": bytes(5000),
    "cut.jpg": b"\xff\xd8\xff\xe0\0\x10JFIF\0",
    "cut.png": b"\x89PNG\r\n\x1a\n\0\0",
    "cut.JPG_large": b"\xff\xd8\xff\xe0\0\x10JFIF\0",
    "cut": b"\xff\xd8\xff\xe0\0\x10JFIF\0",
    "cut.tif": b"II*\0\x08\0\0\0",
    "html.JPG_large": HTML,
}
"""Files whose endings, or whose first bytes, promise a picture that they do not hold."""


def write_pages(path: str, first: np.ndarray, count: int) -> None:
    """A TIFF file of several pages, the first of which is given."""
    with tifffile.TiffWriter(path) as file:
        for number in range(count):
            file.write(first if number == 0 else 255 - first, photometric="rgb")
