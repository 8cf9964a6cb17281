"""What a picture file holds beside its pixels and their colour space."""

from collections.abc import Callable, Mapping
from typing import Any

from PIL import Image, JpegImagePlugin

from skinnet.files import READ_ERRORS
from skinnet.images import _chunks, _segments
from skinnet.images._boxes import EXIF_UUID, XMP_UUID, list_boxes
from skinnet.images._directories import Directory, Tag, read_directory, read_header, write_block
from skinnet.images._exif import strip_prefix
from skinnet.images._resources import make_resources
from skinnet.images._xmp import GAIN_MAP, find_companions

CREDENTIALS = "content credentials (C2PA)"
LAYERS = "layers of Photoshop"

_MOST_PADDING = 256
_KEPT = ("exif", "xmp", "dpi", "comment")
_XMP_KEY = "XML:com.adobe.xmp"
_RAW_KEYS = frozenset(f"Raw profile type {name}" for name in ("exif", "APP1", "xmp"))
"""Texts of ImageMagick that hold EXIF or XMP."""

_COMPRESSION, _PREDICTOR, _XMP, _IPTC, _PHOTOSHOP, _LAYERS = 259, 317, 700, 33723, 34377, 37724
LAYOUT = frozenset(
    {
        *(*range(254, 260), 262, 263, 264, 265, 266, 273, 274, *range(277, 280), 284),
        *(*range(288, 294), 317, 320, *range(321, 326), 330, *range(332, 342), 347),
        *(*range(512, 522), *range(529, 533), 559, 34675),
    }
)
"""TIFF tags on how pixels are stored, which a writer sets anew."""


def keep_metadata(image: Image.Image, data: bytes) -> Mapping[str, Any]:
    """Keep what an open picture holds, for `Picture.metadata`.

    Args:
        image: The picture.
        data: The bytes of its file; empty for a picture from memory.

    Returns:
        `exif` (a TIFF block), `xmp`, `dpi`, `comment`, `photoshop` (image resources), `text` (by
        keyword), `companions` (what lies behind the picture and is not read), `frames`, and what
        the file's own format adds to be written again.
    """
    kept: dict[str, Any] = {key: image.info[key] for key in _KEPT if image.info.get(key)}
    if "exif" in kept:
        kept["exif"] = strip_prefix(kept["exif"])
    if isinstance(kept.get("xmp"), str):
        kept["xmp"] = kept["xmp"].encode()
    frames = getattr(image, "n_frames", 1)
    if frames > 1:
        kept["frames"] = frames
    reader = _READERS.get(image.format or "")
    if reader is not None and data:
        try:
            kept |= reader(image, data, kept)
        except READ_ERRORS:  # the pixels are read all the same
            kept["companions"] = ("damaged metadata",)
    companions = (*kept.pop("companions", ()), *find_companions(kept.get("xmp", b"")))
    if companions:
        kept["companions"] = tuple(dict.fromkeys(companions))
    return kept


def _keep_jpeg(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    segments = list(_segments.list_segments(data))
    found: dict[str, Any] = {
        "segments": segments,
        "tables": image.quantization,  # type: ignore[attr-defined]
        "sampling": JpegImagePlugin.get_sampling(image),
        "progressive": bool(image.info.get("progressive")),
        "rgb": image.info.get("adobe_transform") == 0 and image.mode == "RGB",
    }
    start = _segments.PHOTOSHOP_PREFIX
    parts = [body[len(start) :] for _, body in segments if body.startswith(start)]
    if parts:
        found["photoshop"] = b"".join(parts)
    # Pillow takes a resolution from EXIF too, which is kept as EXIF.
    if not any(body.startswith(_segments.JFIF_PREFIX) for _, body in segments):
        found["dpi"] = None
    gain_map = any(body.startswith(_segments.GAIN_MAP_PREFIX) for _, body in segments)
    index = any(body.startswith(_segments.MPF_PREFIX) for _, body in segments)
    signed = any(
        marker == _segments.JUMBF and body.startswith(_segments.CREDENTIALS_PREFIX)
        for marker, body in segments
    )
    found["companions"] = (
        *((GAIN_MAP,) if gain_map else ()),
        *(("further pictures",) if index and "frames" not in kept else ()),
        *((CREDENTIALS,) if signed else ()),
        *(("data behind the picture",) if _has_trailer(data) else ()),
    )
    return found


def _has_trailer(data: bytes) -> bool:
    """Whether other data follow the last picture, such as the video of a motion photograph."""
    end = data.rfind(b"\xff\xd9")
    return end > 0 and len(data[end + 2 :].strip(b"\0\r\n \xff")) > _MOST_PADDING


def _keep_png(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    chunks = list(_chunks.list_chunks(data))
    found: dict[str, Any] = {"chunks": chunks, "text": {}}
    lost = [CREDENTIALS] if any(name == b"caBX" for name, _ in chunks) else []
    for chunk in chunks:
        try:
            _add_chunk(chunk, found)
        except (ValueError, IndexError):
            key = _chunks.read_key(chunk)
            if key in _RAW_KEYS or key == _XMP_KEY:
                lost.append(f"damaged text ({key})")
            else:
                found["text"][key] = ""
    return found | {"companions": tuple(lost)}


def _add_chunk(chunk: _chunks.Chunk, found: dict[str, Any]) -> None:
    if chunk[0] == b"eXIf":
        found["exif"] = strip_prefix(chunk[1])
    key = _chunks.read_key(chunk)
    if key in _RAW_KEYS:
        raw = _chunks.decode_raw_profile(_chunks.read_text(chunk))
        if not raw.startswith(_segments.EXIF_PREFIX):
            found.setdefault("xmp", raw.removeprefix(_segments.XMP_PREFIX))
        elif "exif" not in found:
            found["exif"] = strip_prefix(raw)
    elif key == _XMP_KEY:
        found["xmp"] = _chunks.read_text(chunk)
    elif key and not key.startswith("Raw profile"):
        encoding = "utf-8" if chunk[0] == b"iTXt" else "latin-1"
        found["text"][key] = _chunks.read_text(chunk).decode(encoding, "replace")


def _keep_tiff(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    header = read_header(data)
    tags = read_directory(data, header)
    compression: Any = image.tag_v2  # type: ignore[attr-defined]
    found: dict[str, Any] = {
        "compression": compression.get(_COMPRESSION, 1),
        "predictor": compression.get(_PREDICTOR, 1) == 2,
    }
    values = {tag: item.value for tag, item in tags.items() if isinstance(item, Tag)}
    if _XMP in values:
        found["xmp"] = values[_XMP]
    if _PHOTOSHOP in values:
        found["photoshop"] = values[_PHOTOSHOP]
    elif _IPTC in values:
        found["photoshop"] = make_resources(values[_IPTC])
    if _IPTC in values:
        found["iptc"] = values[_IPTC]
    if _LAYERS in values:
        found["companions"] = (LAYERS,)
    left = {*LAYOUT, _XMP, _PHOTOSHOP, _IPTC, _LAYERS}
    described: Directory = {tag: item for tag, item in tags.items() if tag not in left}
    if described:
        found["exif"] = write_block(described, header.order)
    return found


def _keep_webp(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    return {"lossless": b"VP8L" in data[12:16] or _has_lossless_chunk(data)}


def _has_lossless_chunk(data: bytes) -> bool:
    at = 12
    while at + 8 <= len(data):
        name, size = data[at : at + 4], int.from_bytes(data[at + 4 : at + 8], "little")
        if name in (b"VP8 ", b"VP8L"):
            return name == b"VP8L"
        at += 8 + size + size % 2
    return False


def _keep_heif(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    found = _note_depth(image.info.get("bit_depth") or 8)
    if any("gainmap" in str(key).lower() for key in image.info.get("aux", {})):
        found["companions"] = (*found.get("companions", ()), GAIN_MAP)
    if image.info.get("depth_images"):
        found["companions"] = (*found.get("companions", ()), "depth map")
    return found


def _keep_jp2(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {"boxes": [], "comment": b""}  # it names the encoder
    for name, body in list_boxes(data):
        if name == b"uuid" and body.startswith(XMP_UUID):
            found["xmp"] = body[len(XMP_UUID) :]
        elif name == b"uuid" and body.startswith(EXIF_UUID):
            found["exif"] = strip_prefix(body[len(EXIF_UUID) :])
        elif name in (b"uuid", b"xml "):
            found["boxes"].append((name, body))
    return found


def _keep_avif(image: Image.Image, data: bytes, kept: Mapping[str, Any]) -> dict[str, Any]:
    at = data.find(b"av1C", 0, 65536)
    flags = data[at + 6] if at > 0 else 0
    return _note_depth(8 if not flags & 0x40 else 12 if flags & 0x20 else 10)


def _note_depth(bits: int) -> dict[str, Any]:
    """What is said of pixels that are read with 8 bits."""
    return {"companions": (f"{bits} bits a channel, of which 8 are read",)} if bits > 8 else {}


_Reader = Callable[[Image.Image, bytes, Mapping[str, Any]], dict[str, Any]]
_READERS: Mapping[str, _Reader] = {
    "JPEG": _keep_jpeg,
    "MPO": _keep_jpeg,
    "PNG": _keep_png,
    "TIFF": _keep_tiff,
    "WEBP": _keep_webp,
    "HEIF": _keep_heif,
    "AVIF": _keep_avif,
    "JPEG2000": _keep_jp2,
}
