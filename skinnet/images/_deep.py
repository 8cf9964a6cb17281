"""Pixels of more than 8 bits a channel in PNG, PPM and JPEG 2000 files, which Pillow reads as 8."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.images._boxes import get_depth, get_enumerated

_Deep = tuple[NDArray[Any], NDArray[Any] | None]
_SYCC = 18


def read_deep(image: Image.Image, data: bytes) -> _Deep | None:
    """Read uint16 pixels, [H, W] or [H, W, 3], and their alpha, as they are stored.

    Args:
        image: The open picture.
        data: The bytes of its file.

    Returns:
        None for pixels of 8 bits, and for those that Pillow reads with 16.
    """
    if image.format == "PNG" and data[24] == 16 and data[25] in (2, 4, 6):
        return _read_png(data)
    if image.format == "PPM" and _read_top(image) > 255:
        return _read_ppm(image, data)
    if image.format == "JPEG2000" and image.mode in ("RGB", "RGBA") and get_depth(data) > 8:
        return None if get_enumerated(data) == _SYCC else _read_jpeg_2000(data)
    return None


def _read_png(data: bytes) -> _Deep:
    from imagecodecs import png_decode

    values = np.asarray(png_decode(data))
    if values.dtype != np.uint16:
        raise ValueError(f"16-bit PNG decoded to {values.dtype}")
    return _split_alpha(values)


def _read_top(image: Image.Image) -> int:
    """The value of white in a binary PPM file, as Pillow has parsed it; 0 of others."""
    tile: Any = image.tile[0] if image.tile else None  # type: ignore[attr-defined]
    if image.mode != "RGB" or tile is None or tile[0] != "ppm":
        return 0
    return int(tile[3][-1] if isinstance(tile[3], tuple) else tile[3])


def _read_ppm(image: Image.Image, data: bytes) -> _Deep:
    start = image.tile[0][2]  # type: ignore[attr-defined]
    shape = (image.height, image.width, 3)
    values = np.frombuffer(data, ">u2", int(np.prod(shape)), start)
    return _scale(values.reshape(shape), _read_top(image)), None


def _read_jpeg_2000(data: bytes) -> _Deep:
    from imagecodecs import jpeg2k_decode

    # The decoder would apply a profile that it finds in the boxes around the codestream.
    codestream = data[data.index(b"\xff\x4f\xff\x51") :]
    values = np.asarray(jpeg2k_decode(codestream))
    return _split_alpha(_scale(values, 2 ** get_depth(data) - 1))


def _scale(values: NDArray[Any], top: int) -> NDArray[np.uint16]:
    if top == 65535:
        return values.astype(np.uint16)
    wide = values.astype(np.uint32).clip(0, top)
    return ((wide * 65535 + top // 2) // top).astype(np.uint16)


def _split_alpha(values: NDArray[Any]) -> _Deep:
    if values.ndim == 2:
        return values, None
    has_alpha = values.shape[2] in (2, 4)
    colour, alpha = (values[..., :-1], values[..., -1]) if has_alpha else (values, None)
    return (colour[..., 0] if colour.shape[2] == 1 else colour), alpha
