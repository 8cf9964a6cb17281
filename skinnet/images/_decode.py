"""Picture files and Pillow images of any format and mode to pictures."""

import warnings
from collections.abc import Mapping
from io import BytesIO
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._colour_decision import decide_colour_space
from skinnet.images._pixels import read_pixels
from skinnet.images.picture import Picture

MAX_PIXELS = 100_000_000
"""Largest photograph that is decoded; its arrays take about 4 GB."""

PHOTO_FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "MPO")
"""Formats that Pillow reads; its others hold no photographs or start other programs."""

PHOTO_SUFFIXES = frozenset(
    ".jpg .jpeg .png .tif .tiff .webp .avif .jp2 .bmp .gif .ppm .pgm .pnm .mpo".split()
)
"""Suffixes of the files that are taken as photographs in a folder."""

_HEIF_BRANDS = frozenset(b"heic heix heim heis hevc hevx mif1 msf1".split())
_DAMAGES = (Image.DecompressionBombError, *READ_ERRORS)
_ORIENTATION = 0x0112
_INVERSE = {6: 8, 8: 6}
"""Orientations whose turn is undone by another one."""

_METADATA = ("exif", "xmp", "dpi", "comment", "photoshop")


def decode_file(file: BinaryIO | BytesIO, name: str, upright: bool = True) -> Picture:
    """Decode an open picture file; `upright` applies the orientation that EXIF states."""
    data = file.read()
    if not data:
        raise InputError(f"{name} is empty (0 bytes); was it copied completely?")
    with warnings.catch_warnings():
        # Pillow warns of large pictures, which have their own limit here, and of odd metadata.
        warnings.simplefilter("ignore")
        return decode_image(_open(data, name), name, data, upright)


def decode_image(image: Image.Image, name: str, data: bytes = b"", upright: bool = True) -> Picture:
    """Decode a Pillow image; `data` are the bytes of its file, if there is one."""
    width, height = image.size
    check_size(width, height, name)
    try:
        picture = _decode(image, name, data, upright)
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far ") from error
    except READ_ERRORS as error:
        raise InputError(
            f"{name} is damaged or cut short ({error}); copy or download it again."
        ) from error
    if picture.pixels.size == 0:
        raise InputError(f"{name} is {width} x {height} pixels, so it is empty; give another file.")
    return picture


def check_size(width: int, height: int, name: str) -> None:
    """Raise `InputError` for more than `MAX_PIXELS` pixels."""
    if width * height > MAX_PIXELS:
        raise _too_large(name, f"{width} x {height}, ")


def _decode(image: Image.Image, name: str, data: bytes, upright: bool) -> Picture:
    stated = _find_orientation(image)
    pixels = read_pixels(image, data, name)
    # Pillow turns TIFF pixels itself, and then no longer states an orientation.
    turned = _find_orientation(image) != stated
    if upright:
        wanted = 1 if turned else stated
    else:
        wanted = _INVERSE.get(stated, stated) if turned else 1
    space, notes = decide_colour_space(image, data, pixels.channels, name)
    picture = Picture(
        name,
        _turn(pixels.colour, wanted),
        None if pixels.alpha is None else _turn(pixels.alpha, wanted),
        space,
        image.format or "",
        _keep_metadata(image),
        (*notes, *_count_frames(image, name)),
    )
    _ = picture.srgb  # damage that the profile shows is damage of the file
    return picture


def _keep_metadata(image: Image.Image) -> Mapping[str, Any]:
    return {key: image.info[key] for key in _METADATA if key in image.info}


def _count_frames(image: Image.Image, name: str) -> tuple[str, ...]:
    frames = getattr(image, "n_frames", 1)
    return () if frames == 1 else (f"{name} holds {frames} pictures; the first is read.",)


def _open(data: bytes, name: str) -> Image.Image:
    if is_heif(data):
        return _open_heif(data, name)
    Image.init()
    formats = [known for known in PHOTO_FORMATS if known in Image.OPEN]
    try:
        return Image.open(BytesIO(data), formats=formats)
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far ") from error
    except READ_ERRORS as error:
        raise InputError(
            f"{name} is not a picture that can be read; give a JPEG, PNG, TIFF or WebP file."
        ) from error


def is_heif(data: bytes) -> bool:
    """Whether the first bytes of a file are those of a HEIC or HEIF picture."""
    brands = {data[8:12], *(data[at : at + 4] for at in range(16, min(len(data), 64), 4))}
    return data[4:8] == b"ftyp" and b"avif" not in brands and bool(_HEIF_BRANDS & brands)


def _open_heif(data: bytes, name: str) -> Image.Image:
    try:
        import pillow_heif
    except ModuleNotFoundError as error:
        raise InputError(
            f'{name} is a HEIC picture, which needs an extra: pip install "skinnet[heif]"; '
            "or save it as JPEG."
        ) from error
    try:
        image: Image.Image = pillow_heif.open_heif(BytesIO(data)).to_pillow()
    except _DAMAGES as error:
        raise InputError(
            f"{name} is damaged or cut short ({error}); copy or download it again."
        ) from error
    image.format = "HEIF"
    return image


def _too_large(name: str, size: str) -> InputError:
    return InputError(
        f"{name} has {size}more pixels than the limit of {MAX_PIXELS:,}; scale it down first."
    )


def _find_orientation(image: Image.Image) -> int:
    try:
        return int(image.getexif().get(_ORIENTATION, 1))
    except READ_ERRORS:  # damaged metadata; viewers show such pixels as they are stored
        return 1


def _turn(values: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Turn stored pixels upright by the orientation that EXIF states, 1 to 8."""
    if orientation in (5, 6, 7, 8):
        values = values.swapaxes(0, 1)
    rows = slice(None, None, -1 if orientation in (3, 4, 7, 8) else 1)
    columns = slice(None, None, -1 if orientation in (2, 3, 6, 7) else 1)
    return np.ascontiguousarray(values[rows, columns])
