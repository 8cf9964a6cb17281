"""Linear sRGB to pixels as a file stores them."""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.files import READ_ERRORS
from skinnet.images._icc import convert_pixels, make_linear_profile
from skinnet.images.srgb import linear_to_srgb


def encode_linear(
    linear: NDArray[np.float32], old: NDArray[Any], profile: bytes | None
) -> NDArray[Any]:
    """Encode linear sRGB [H, W, 3] as pixels of the depth and channels of `old`.

    Args:
        linear: The colours; what the colour space cannot hold is clipped.
        old: The pixels that are replaced, RGB [H, W, 3] or CMYK [H, W, 4].
        profile: The profile of the pixels; None for sRGB, and for CMYK without a profile.
    """
    if old.shape[2] == 4:
        return _encode_cmyk(linear, old, profile)
    if profile is not None:
        return convert_pixels(linear, make_linear_profile(), profile, old.dtype)
    values: NDArray[Any] = np.rint(linear_to_srgb(linear) * np.iinfo(old.dtype).max)
    return values.astype(old.dtype)


@lru_cache(8)
def is_invertible(profile: bytes) -> bool:
    """Whether colours can be converted to a profile; one of a scanner may lack that way."""
    try:
        convert_pixels(np.zeros((1, 1, 3), np.float32), make_linear_profile(), profile, np.uint16)
    except READ_ERRORS:  # CmsError is a RuntimeError
        return False
    return True


def _encode_cmyk(
    linear: NDArray[np.float32], old: NDArray[Any], profile: bytes | None
) -> NDArray[Any]:
    """CMYK whose black is separated as that of the old pixels is.

    Many CMYK values have the same colour. The difference that the separation makes between old and
    new colours is added to the old values.
    """
    top = float(np.iinfo(old.dtype).max)
    if profile is None:
        return _encode_plain_cmyk(linear, old)
    before = convert_pixels(old, profile, make_linear_profile(), np.float32)
    new, was = (
        convert_pixels(each.astype(np.float32), make_linear_profile(), profile, np.uint16)
        for each in (linear, before)
    )
    difference = (new.astype(np.float32) - was.astype(np.float32)) * (top / 65535)
    values: NDArray[Any] = np.rint(old + difference).clip(0, top).astype(old.dtype)
    return values


def _encode_plain_cmyk(linear: NDArray[np.float32], old: NDArray[Any]) -> NDArray[Any]:
    """CMYK without a profile, by Pillow's formula RGB = (1 - CMY) (1 - K)."""
    top = float(np.iinfo(old.dtype).max)
    rgb = linear_to_srgb(linear)
    white = np.maximum(1 - old[..., 3:] / top, rgb.max(-1, keepdims=True))
    inks = 1 - rgb / np.maximum(white, 1 / top)
    values = np.rint(np.concatenate([inks, 1 - white], -1) * top).clip(0, top)
    return values.astype(old.dtype)
