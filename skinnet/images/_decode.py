"""Pillow images of any mode and profile as RGB in sRGB."""

from io import BytesIO

import numpy as np
from PIL import Image, ImageCms

from skinnet.errors import InputError
from skinnet.files import BROKEN

_EIGHT_BIT = frozenset("1 L LA La P PA RGB RGBA RGBa RGBX CMYK YCbCr HSV".split())
_STRAIGHT = {"La": "LA", "RGBa": "RGBA"}
_SPACES = {("RGB", "RGB"): "RGB", ("L", "GRAY"): "L", ("L", "RGB"): "RGB", ("CMYK", "CMYK"): "CMYK"}


def to_srgb(image: Image.Image, name: str) -> Image.Image:
    """An image as RGB in sRGB by its own profile, transparency laid on white.

    An image without a profile is taken as sRGB. `name` stands for the image in errors. Raises
    `InputError` for modes without a set white, and for a profile that cannot be used.
    """
    plain = _plain(image, name)
    alpha = plain.convert("RGBA").getchannel("A") if plain.has_transparency_data else None
    rgb = _apply_profile(_opaque(plain), image.info.get("icc_profile"), name)
    if alpha is None:
        return rgb
    white = Image.new("RGB", rgb.size, (255, 255, 255))
    white.paste(rgb, mask=alpha)
    return white


def _plain(image: Image.Image, name: str) -> Image.Image:
    """The image in a mode of 8 bits a channel, alpha not multiplied in."""
    if image.mode.startswith("I;16") or (image.mode == "I" and image.format in ("PNG", "PPM")):
        grey = np.asarray(image).astype(np.uint32).clip(0, 65535)
        return Image.fromarray(((grey + 128) // 257).astype(np.uint8))
    if image.mode not in _EIGHT_BIT:
        raise InputError(
            f"{name} has pixels of Pillow's mode {image.mode}, whose white is not known; "
            "save it as 8-bit or 16-bit sRGB."
        )
    return image.convert(_STRAIGHT[image.mode]) if image.mode in _STRAIGHT else image


def _opaque(plain: Image.Image) -> Image.Image:
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
    except (ImageCms.PyCMSError, *BROKEN) as error:
        raise InputError(
            f"{name} has a colour profile that cannot be used with its {image.mode} pixels; "
            "save it again as sRGB, or without a profile."
        ) from error
    assert converted is not None  # None is for conversions in place
    return converted
