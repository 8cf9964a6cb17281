"""Picture files and Pillow images of any format, mode and colour profile to sRGB."""

import os
import warnings
from io import BytesIO
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS

MAX_PIXELS = 100_000_000
"""Largest photograph that is decoded; its arrays take about 4 GB."""

PHOTO_FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "MPO")
"""Formats that are read; Pillow's others hold no photographs or start other programs."""

PHOTO_SUFFIXES = frozenset(
    ".jpg .jpeg .png .tif .tiff .webp .avif .jp2 .bmp .gif .ppm .pgm .pnm .mpo".split()
)
"""Suffixes of the files that are taken as photographs in a folder."""

_EIGHT_BIT = frozenset("1 L LA La P PA RGB RGBA RGBa RGBX CMYK YCbCr HSV".split())
_STRAIGHT = {"La": "LA", "RGBa": "RGBA"}
_SPACES = {("RGB", "RGB"): "RGB", ("L", "GRAY"): "L", ("L", "RGB"): "RGB", ("CMYK", "CMYK"): "CMYK"}
_ORIENTATION = 0x0112
_TRANSPOSES = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}


def decode_file(file: BinaryIO | BytesIO, name: str) -> NDArray[np.uint8]:
    """Decode an open picture file to upright uint8 sRGB [H, W, 3]."""
    if file.seek(0, os.SEEK_END) == 0:
        raise InputError(f"{name} is empty (0 bytes); was it copied completely?")
    file.seek(0)
    with warnings.catch_warnings():
        # Pillow warns of large pictures, which have their own limit here, and of odd metadata.
        warnings.simplefilter("ignore")
        return decode_image(_open(file, name), name)


def decode_image(image: Image.Image, name: str) -> NDArray[np.uint8]:
    """Decode a Pillow image to upright uint8 sRGB [H, W, 3]."""
    width, height = image.size
    check_size(width, height, name)
    try:
        image.load()
        rgb, transpose = to_srgb(image, name), _find_transpose(image)
        photo = np.array(rgb if transpose is None else rgb.transpose(transpose))
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far ") from error
    except READ_ERRORS as error:
        raise InputError(
            f"{name} is damaged or cut short ({error}); copy or download it again."
        ) from error
    if photo.size == 0:
        raise InputError(f"{name} is {width} x {height} pixels, so it is empty; give another file.")
    return photo


def check_size(width: int, height: int, name: str) -> None:
    """Raise `InputError` for more than `MAX_PIXELS` pixels."""
    if width * height > MAX_PIXELS:
        raise _too_large(name, f"{width} x {height}, ")


def to_srgb(image: Image.Image, name: str) -> Image.Image:
    """Convert an image to RGB in sRGB by its own profile; blend transparent pixels with white.

    An image without a profile is taken as sRGB. Error messages contain `name`. Raises `InputError`
    for modes without a known white, and for a profile that cannot be used.
    """
    plain = _to_eight_bits(image, name)
    alpha = plain.convert("RGBA").getchannel("A") if plain.has_transparency_data else None
    rgb = _apply_profile(_drop_alpha(plain), image.info.get("icc_profile"), name)
    if alpha is None:
        return rgb
    white = Image.new("RGB", rgb.size, (255, 255, 255))
    white.paste(rgb, mask=alpha)
    return white


def _open(file: BinaryIO | BytesIO, name: str) -> Image.Image:
    Image.init()
    formats = [known for known in PHOTO_FORMATS if known in Image.OPEN]
    try:
        return Image.open(file, formats=formats)
    except Image.DecompressionBombError as error:
        raise _too_large(name, "far ") from error
    except READ_ERRORS as error:
        raise InputError(
            f"{name} is not a picture that can be read; give a JPEG, PNG, TIFF or WebP file."
        ) from error


def _too_large(name: str, size: str) -> InputError:
    return InputError(
        f"{name} has {size}more pixels than the limit of {MAX_PIXELS:,}; scale it down first."
    )


def _find_transpose(image: Image.Image) -> Image.Transpose | None:
    try:
        return _TRANSPOSES.get(image.getexif().get(_ORIENTATION, 1))
    except READ_ERRORS:  # damaged metadata; viewers show such pixels as they are stored
        return None


def _to_eight_bits(image: Image.Image, name: str) -> Image.Image:
    """Convert to a mode of 8 bits a channel, alpha not multiplied in."""
    if image.mode.startswith("I;16") or (image.mode == "I" and image.format in ("PNG", "PPM")):
        grey = np.asarray(image).astype(np.uint32).clip(0, 65535)
        return Image.fromarray(((grey + 128) // 257).astype(np.uint8))
    if image.mode not in _EIGHT_BIT:
        raise InputError(
            f"{name} has pixels of Pillow's mode {image.mode}, whose white is not known; "
            "save it as 8-bit or 16-bit sRGB."
        )
    return image.convert(_STRAIGHT[image.mode]) if image.mode in _STRAIGHT else image


def _drop_alpha(plain: Image.Image) -> Image.Image:
    if plain.mode == "CMYK":
        # Pillow inverts every CMYK JPEG, as Adobe's are; others are not written inverted.
        adobe = plain.format != "JPEG" or "adobe" in plain.info
        return plain if adobe else plain.point(lambda value: 255 - value)
    return plain.convert("L" if plain.mode in ("1", "L", "LA") else "RGB")


def _apply_profile(image: Image.Image, profile: bytes | None, name: str) -> Image.Image:
    if not profile:
        return image.convert("RGB")
    try:
        source = ImageCms.ImageCmsProfile(BytesIO(profile))
        mode = _SPACES[image.mode, source.profile.xcolor_space.strip()]
        converted = ImageCms.profileToProfile(
            image.convert(mode),
            source,
            ImageCms.createProfile("sRGB"),
            ImageCms.Intent.RELATIVE_COLORIMETRIC,
            "RGB",
            flags=ImageCms.Flags.BLACKPOINTCOMPENSATION,
        )
    except (ImageCms.PyCMSError, *READ_ERRORS) as error:
        raise InputError(
            f"{name} has a colour profile that cannot be used with its {image.mode} pixels; "
            "save it again as sRGB, or without a profile."
        ) from error
    assert converted is not None  # None is for conversions in place
    return converted
