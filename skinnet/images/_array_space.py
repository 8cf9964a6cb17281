"""The colour space that a caller states for an array."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._icc import fits_pixels
from skinnet.images._named_spaces import ADOBE_RGB, DISPLAY_P3, SRGB
from skinnet.images.colour_space import ColourSpace
from skinnet.images.srgb import linear_to_srgb

_LINEAR = "linear sRGB"
_NAMED = {space.name.casefold(): space for space in (SRGB, DISPLAY_P3, ADOBE_RGB)}
_TOP = 65535


def choose_space(space: str | ColourSpace | None) -> tuple[ColourSpace, bool]:
    """Choose the colour space of an array, and say whether its values are linear light.

    Linear light is encoded as sRGB before it is kept: 8 bits of it are too coarse where it is dark.

    Raises:
        InputError: There is no space of this name, or its profile is not one of RGB.
    """
    if space is None:
        return ColourSpace("sRGB", "assumed"), False
    if isinstance(space, ColourSpace):
        if space.profile is not None and not fits_pixels(space.profile, "RGB"):
            raise InputError(f"The colour space {space.name} is not one of RGB; convert to sRGB.")
        return space, False
    if not isinstance(space, str) or space.casefold() not in (_LINEAR.casefold(), *_NAMED):
        names = ", ".join((_LINEAR, *(each.name for each in _NAMED.values())))
        raise InputError(f"colour_space is {names}, or a ColourSpace; got {space!r:.80}.")
    if space.casefold() == _LINEAR.casefold():
        return ColourSpace("sRGB", "argument"), True
    named = _NAMED[space.casefold()]
    return ColourSpace(named.name, "argument", named.profile()), False


def encode_linear_light(pixels: NDArray[Any]) -> NDArray[np.uint16]:
    """Encode linear light, uint8 or uint16 of full range, as sRGB of uint16."""
    linear = pixels.astype(np.float32) / np.float32(np.iinfo(pixels.dtype).max)
    return np.asarray(np.rint(linear_to_srgb(linear) * _TOP), np.uint16)
