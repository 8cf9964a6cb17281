"""Picture files and Pillow images of any format and mode to pictures."""

import warnings
from io import BytesIO
from typing import Any, BinaryIO

from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._chunks import has_sound_pixels
from skinnet.images._colour_decision import decide_colour_space
from skinnet.images._frames import describe_frames
from skinnet.images._kind import HEIF, OTHER, PICTURE, RAW, Kind, identify
from skinnet.images._metadata import keep_metadata
from skinnet.images._pixels import read_pixels
from skinnet.images._raw.raw_file import read_raw
from skinnet.images._silence import silence_libraries
from skinnet.images.picture import Picture

MAX_PIXELS = 100_000_000
"""Largest photograph that is decoded; its arrays take about 4 GB."""

_FEW_PIXELS, _PIXELS_A_BYTE = 4_000_000, 1000
"""Pictures that are never too large, and pixels of a byte; strong compression reaches a hundred."""

PHOTO_FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "MPO")
"""Formats that Pillow reads; its others hold no photographs or start other programs."""

_PALETTE = (
    "{} has a palette of at most 256 colours, in which the fine differences of skin are lost; give "
    "the photograph that it was made from."
)

_DAMAGES = (Image.DecompressionBombError, *READ_ERRORS)
_SUBFILE_TYPE, _PHOTOMETRIC, _DNG_VERSION = 254, 262, 50706
_RAW_PHOTOMETRICS = (32803, 34892)
"""A mosaic of colour filters, and linear raw pixels."""


def decode_file(file: BinaryIO | BytesIO, name: str, upright: bool = True) -> Picture:
    """Decode an open picture file; `upright` applies the orientation that EXIF states."""
    silence_libraries()
    data = file.read()
    if not data:
        raise InputError(f"{name} is empty (0 bytes); was it copied completely?")
    kind = identify(BytesIO(data), name)
    if kind is RAW:  # before Pillow, which would show the preview in it
        return read_raw(data, name, MAX_PIXELS, upright)
    with warnings.catch_warnings():
        # Pillow warns of large pictures, which have their own limit here, and of odd metadata.
        warnings.simplefilter("ignore")
        return decode_image(_open(data, name, kind), name, data, upright)


def decode_image(image: Image.Image, name: str, data: bytes = b"", upright: bool = True) -> Picture:
    """Decode a Pillow image; `data` are the bytes of its file, if there is one."""
    width, height = image.size
    check_size(width, height, name)
    _check_density(width * height, len(data), name)
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


def _check_density(pixels: int, size: int, name: str) -> None:
    """Refuse a few bytes that state many pixels, before these are decoded."""
    if size and pixels > max(_FEW_PIXELS, _PIXELS_A_BYTE * size):
        raise InputError(
            f"{name} states {pixels / 1e6:.0f} megapixels in {size / 1e3:,.0f} KB, which no "
            "photograph does; it is of one colour or damaged. Copy or download it again."
        )


def _decode(image: Image.Image, name: str, data: bytes, upright: bool) -> Picture:
    if image.format == "TIFF":
        _refuse_raw(image, name)
    if image.format == "PNG" and data and not has_sound_pixels(data):
        # Pillow does not compare them, and shows other pixels from the fault on.
        raise ValueError("its pixels do not have the checksum that it states")
    has_palette = image.mode in ("P", "PA")
    pixels = read_pixels(image, data, name, upright)
    space, notes = decide_colour_space(image, data, pixels.channels, name)
    picture = Picture(
        name,
        pixels.colour,
        pixels.alpha,
        space,
        image.format or "",
        keep_metadata(image, data),
        (*notes, *describe_frames(image, data, name), *([_PALETTE.format(name)] * has_palette)),
    )
    _ = picture.srgb  # damage that the profile shows is damage of the file
    return picture


def _refuse_raw(image: Image.Image, name: str) -> None:
    """Refuse previews and mosaics, also of an image from memory, whose file is not known."""
    tags: Any = image.tag_v2  # type: ignore[attr-defined]
    mosaic = tags.get(_PHOTOMETRIC) in _RAW_PHOTOMETRICS or _DNG_VERSION in tags
    reduced = int(tags.get(_SUBFILE_TYPE, 0)) & 1
    if mosaic or reduced:
        raise InputError(
            f"{name} is a RAW file, or one that begins with a preview; give the path of a RAW "
            "file, or develop it to JPEG, PNG or TIFF in sRGB."
        )


def _open(data: bytes, name: str, kind: Kind) -> Image.Image:
    if kind is HEIF:
        return _open_heif(data, name)
    if kind not in (PICTURE, OTHER):
        raise InputError(f"{name} is {kind.one}, not a picture that can be read; {kind.remedy}.")
    Image.init()
    formats = [known for known in PHOTO_FORMATS if known in Image.OPEN]
    try:
        return Image.open(BytesIO(data), formats=formats)
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far ") from error
    except READ_ERRORS as error:
        if kind is PICTURE:
            raise InputError(
                f"{name} is damaged or cut short, or of a variant that is not read; copy or "
                "download it again, or save it as JPEG or PNG."
            ) from error
        raise InputError(
            f"{name} is not a picture that can be read; give a JPEG, PNG, TIFF or WebP file."
        ) from error


def _open_heif(data: bytes, name: str) -> Image.Image:
    try:
        import pillow_heif
    except ModuleNotFoundError as error:
        raise InputError(
            f'{name} is a HEIC picture, which needs an extra: pip install "skinnet[heif]"; '
            "or save it as JPEG."
        ) from error
    try:
        container = pillow_heif.open_heif(BytesIO(data))
        image: Image.Image = container.to_pillow()
    except _DAMAGES as error:
        raise InputError(
            f"{name} is damaged or cut short ({error}); copy or download it again."
        ) from error
    image.format, image.n_frames = "HEIF", len(container)  # type: ignore[attr-defined]
    return image


def _too_large(name: str, size: str) -> InputError:
    return InputError(
        f"{name} has {size}more pixels than the limit of {MAX_PIXELS:,}; scale it down first."
    )
