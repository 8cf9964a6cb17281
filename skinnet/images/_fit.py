"""Pictures made to fit formats that hold less."""

from dataclasses import replace

import numpy as np

from skinnet.images._icc import convert_pixels, make_srgb_profile
from skinnet.images._plain import guess_rgb, to_eight_bits
from skinnet.images.colour_space import ColourSpace
from skinnet.images.picture import Picture

_STRIP = 128


def convert_to_srgb(picture: Picture) -> Picture:
    """Convert RGB or CMYK pixels to sRGB at their own depth."""
    profile = picture.colour_space.profile
    if profile is not None:
        pixels = convert_pixels(picture.pixels, profile, make_srgb_profile(), picture.pixels.dtype)
    elif picture.pixels.shape[2] == 4:
        pixels = guess_rgb(picture.pixels)
    else:
        return picture
    return replace(picture, pixels=pixels, colour_space=ColourSpace("sRGB", "assumed"))


def blend_with_white(picture: Picture) -> Picture:
    """Blend transparent pixels with white, in the values of the pixels, as viewers do."""
    if picture.alpha is None:
        return picture
    pixels = picture.pixels.copy()
    top = int(np.iinfo(pixels.dtype).max)
    white = 0 if pixels.shape[2] == 4 else top
    for start in range(0, pixels.shape[0], _STRIP):
        rows = slice(start, start + _STRIP)
        alpha = picture.alpha[rows, :, None].astype(np.float64) / top
        pixels[rows] = np.rint(white + alpha * (pixels[rows].astype(np.float64) - white))
    return replace(picture, pixels=pixels, alpha=None)


def reduce_depth(picture: Picture) -> Picture:
    """Round 16 bits to 8."""
    if picture.pixels.dtype == np.uint8:
        return picture
    alpha = None if picture.alpha is None else to_eight_bits(picture.alpha)
    return replace(picture, pixels=to_eight_bits(picture.pixels), alpha=alpha)
