"""Writer of JPEG 2000 files (JP2), without loss."""

import struct
from pathlib import Path

from skinnet.images._boxes import EXIF_UUID, XMP_UUID, Box, join_boxes, list_boxes
from skinnet.images._carried import Carried
from skinnet.images._mark import append_mark
from skinnet.images._writers import join_alpha
from skinnet.images.picture import Picture

_HEADER, _CODESTREAM = b"jp2h", b"jp2c"
_SRGB = b"\x01\0\0" + struct.pack(">I", 16)
_RESTRICTED_PROFILE = b"\x02\0\0"
_ALPHA = struct.pack(">H12H", 4, 0, 0, 1, 1, 0, 2, 2, 0, 3, 3, 1, 0)
"""What the four channels are: red, green, blue, and opacity of the whole picture."""


def write_jp2(path: Path, picture: Picture, carried: Carried) -> None:
    """Write a JP2 file."""
    from imagecodecs import jpeg2k_encode

    encoded = bytes(jpeg2k_encode(join_alpha(picture), level=0, codecformat="jp2"))
    boxes = list(list_boxes(encoded))
    inner = dict(list_boxes(dict(boxes)[_HEADER]))
    space = _RESTRICTED_PROFILE + carried.profile if carried.profile else _SRGB
    header = [(name, body) for name, body in inner.items() if name in (b"ihdr", b"bpcc")]
    header.append((b"colr", space))
    if picture.alpha is not None:
        header.append((b"cdef", _ALPHA))
    if carried.dpi:
        header.append((b"res ", join_boxes([(b"resc", _make_resolution(carried.dpi))])))
    extra = list(carried.own.get("boxes", ()))
    if carried.exif:
        extra.append((b"uuid", EXIF_UUID + carried.exif))
    if carried.xmp:
        extra.append((b"uuid", XMP_UUID + carried.xmp))
    whole: list[Box] = []
    for name, body in boxes:
        whole.append((name, join_boxes(header) if name == _HEADER else body))
        if name == _HEADER:
            whole += extra
    path.write_bytes(join_boxes(whole))
    if carried.mark is not None:
        append_mark(path, carried.mark)


def _make_resolution(dpi: tuple[float, float]) -> bytes:
    """Pixels in a metre, down and across, as fractions."""
    x, y = (min(round(value / 0.0254), 65535) for value in dpi)
    return struct.pack(">4H2b", y, 1, x, 1, 0, 0)
