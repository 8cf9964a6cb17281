"""Photographs as uint8 sRGB arrays, and PNG files with the meaning of their pixels."""

import os
import warnings
from collections.abc import Mapping
from io import BufferedIOBase, BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from skinnet.errors import InputError
from skinnet.files import BROKEN, atomic
from skinnet.images._decode import to_srgb

MAX_PIXELS = 100_000_000
"""Largest photograph that is decoded; the arrays of one such take some 4 GB."""

FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "MPO")
"""Formats that are read; Pillow's others hold no photographs or start other programs."""

SUFFIXES = frozenset(
    ".jpg .jpeg .png .tif .tiff .webp .avif .jp2 .bmp .gif .ppm .pgm .pnm .mpo".split()
)
"""Suffixes by which photographs in a folder are known."""


_ORIENTATION = 0x0112
_TURNS = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}


def read_photo(
    source: str | Path | BinaryIO | BufferedIOBase, name: str | None = None
) -> NDArray[np.uint8]:
    """Read a photograph as uint8 sRGB [H, W, 3], upright, without alpha.

    EXIF orientation is applied, embedded colour profiles are converted to sRGB, transparency is
    laid on white, and of several frames the first is read. `name` stands for the photograph in
    errors. Raises `InputError` for what is missing, no picture, damaged, larger than `MAX_PIXELS`,
    or of a kind whose values have no set white.
    """
    if not isinstance(source, str | Path):
        return _read(BytesIO(source.read()), name or "The data")
    path = Path(source)
    if path.is_dir():
        raise InputError(f"{path} is a folder; give a photograph in it.")
    try:
        with path.open("rb") as file:
            return _read(file, name or str(path))
    except FileNotFoundError:
        raise InputError(f"There is no file {path}; check the path.") from None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path} cannot be read: {error}.") from error


def as_photo(image: str | Path | Image.Image | NDArray[Any]) -> NDArray[np.uint8]:
    """A path, a Pillow image or an array as uint8 sRGB [H, W, 3].

    Arrays are sRGB, [H, W], [H, W, 1], [H, W, 3] or [H, W, 4], uint8 or float in [0, 1]; alpha is
    laid on white. Raises `InputError`, which is a `ValueError`, for anything else.
    """
    if isinstance(image, np.ndarray):
        return _from_array(image)
    if isinstance(image, Image.Image):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return _decode(image, "The image")
    if isinstance(image, str | Path):
        return read_photo(image)
    raise InputError(f"An image is a path, a Pillow image or an array; got {type(image).__name__}.")


def write_png(path: Path, array: NDArray[Any], text: Mapping[str, str] | None = None) -> None:
    """Write uint8 sRGB [H, W, 3] or uint16 grey [H, W] atomically, with `text` as tEXt chunks."""
    kind = (array.dtype, array.shape[2:])
    if kind not in ((np.dtype(np.uint8), (3,)), (np.dtype(np.uint16), ())):
        raise ValueError(f"PNG is written from uint8 [H, W, 3] or uint16 [H, W]; got {kind}.")
    info = PngImagePlugin.PngInfo()
    for key, value in (text or {}).items():
        info.add_text(key, value)
    with atomic(path) as part:
        # The fast level: the low bits of interpolated maps are noise that no level compresses.
        Image.fromarray(array).save(part, "PNG", pnginfo=info, compress_level=1)


def srgb_to_linear(srgb: NDArray[Any]) -> NDArray[np.float32]:
    """Linear sRGB, float32 in [0, 1], of sRGB as uint8 or as floats in [0, 1] (IEC 61966-2-1)."""
    if srgb.dtype == np.uint8:
        return np.take(srgb_to_linear(np.arange(256, dtype=np.float32) / 255), srgb)
    value = np.asarray(srgb, np.float32)
    curve = ((np.maximum(value, 0) + 0.055) / 1.055) ** 2.4
    return np.where(value <= 0.04045, value / 12.92, curve).astype(np.float32)


def linear_to_srgb(linear: NDArray[Any]) -> NDArray[np.float32]:
    """sRGB in [0, 1] of linear sRGB, clipped to [0, 1] (IEC 61966-2-1)."""
    value = np.clip(np.asarray(linear, np.float32), 0, 1)
    curve = 1.055 * value ** (1 / 2.4) - 0.055
    return np.where(value <= 0.0031308, value * 12.92, curve).astype(np.float32)


def to_uint8(srgb: NDArray[Any]) -> NDArray[np.uint8]:
    """sRGB in [0, 1] as uint8, rounded and clipped."""
    value: NDArray[np.uint8] = np.rint(np.clip(srgb, 0, 1) * 255).astype(np.uint8)
    return value


def _from_array(array: NDArray[Any]) -> NDArray[np.uint8]:
    grey = array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 1)
    if (not grey and not (array.ndim == 3 and array.shape[2] in (3, 4))) or array.size == 0:
        raise InputError(
            f"A photograph is [H, W], [H, W, 3] or [H, W, 4]; got shape {list(array.shape)}."
        )
    if array.shape[0] * array.shape[1] > MAX_PIXELS:
        raise InputError(_too_large("The array", f"{array.shape[1]} x {array.shape[0]}, "))
    value = array if array.dtype == np.uint8 else to_uint8(_checked_floats(array))
    value = np.repeat(value.reshape(*array.shape[:2], 1), 3, 2) if grey else value
    return np.array(to_srgb(Image.fromarray(value), "The array"))


def _checked_floats(array: NDArray[Any]) -> NDArray[np.float32]:
    if not np.issubdtype(array.dtype, np.floating):
        raise InputError(
            f"A photograph is uint8 or floats in [0, 1]; got {array.dtype}. "
            "Divide it by its white first."
        )
    outside = array[~((array >= 0) & (array <= 1))]
    if outside.size:
        raise InputError(
            f"A photograph of floats lies in [0, 1]; got {outside[0]:g}. "
            "Divide it by 255 if it was read from a file."
        )
    return array.astype(np.float32)


def _read(file: BinaryIO | BytesIO, name: str) -> NDArray[np.uint8]:
    if file.seek(0, os.SEEK_END) == 0:
        raise InputError(f"{name} is empty (0 bytes); was it copied whole?")
    file.seek(0)
    with warnings.catch_warnings():
        # Pillow warns of large pictures, which have their own limit here, and of odd metadata.
        warnings.simplefilter("ignore")
        return _decode(_open(file, name), name)


def _open(file: BinaryIO | BytesIO, name: str) -> Image.Image:
    Image.init()
    formats = [known for known in FORMATS if known in Image.OPEN]
    try:
        return Image.open(file, formats=formats)
    except Image.DecompressionBombError as error:
        raise InputError(_too_large(name, "")) from error
    except BROKEN as error:
        raise InputError(
            f"{name} is not a picture that can be read; give a JPEG, PNG, TIFF or WebP file."
        ) from error


def _too_large(name: str, size: str) -> str:
    return (
        f"{name} has {size or 'far '}more pixels than the limit of {MAX_PIXELS:,}; "
        "scale it down first."
    )


def _decode(image: Image.Image, name: str) -> NDArray[np.uint8]:
    width, height = image.size
    if width * height > MAX_PIXELS:
        raise InputError(_too_large(name, f"{width} x {height}, "))
    try:
        image.load()
        rgb, turn = to_srgb(image, name), _turn(image)
        photo = np.array(rgb if turn is None else rgb.transpose(turn))
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise InputError(_too_large(name, "")) from error
    except BROKEN as error:
        raise InputError(
            f"{name} is damaged or cut short ({error}); copy or download it again."
        ) from error
    if photo.size == 0:
        raise InputError(f"{name} is {width} x {height} pixels: there is nothing in it.")
    return photo


def _turn(image: Image.Image) -> Image.Transpose | None:
    try:
        return _TURNS.get(image.getexif().get(_ORIENTATION, 1))
    except BROKEN:  # damaged metadata around sound pixels, which viewers show as they lie
        return None
