"""Photographs whose tone curve is undone, and pictures to which it is applied again."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from skinnet.images.picture import Picture
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference._references.tone_curve import ToneCurve

_STRIP = 256
"""Rows that are converted at once, to save memory."""


def linearise(picture: Picture, tone: ToneCurve) -> Picture:
    """Undo a tone curve; the result is 8-bit sRGB of linear light."""
    pixels = _convert(picture.srgb, lambda display: linear_to_srgb(tone.undo(display)))
    return Picture(
        picture.name,
        pixels,
        None if picture.alpha is None else picture.alpha,
        format=picture.format,
        metadata=picture.metadata,
        notes=picture.notes,
    )


def restore_tones(srgb: NDArray[np.uint8], tone: ToneCurve) -> NDArray[np.uint8]:
    """Apply a tone curve to linear light in 8-bit sRGB."""
    return _convert(srgb, lambda display: tone.apply(srgb_to_linear(display).astype(np.float64)))


def _convert(
    srgb: NDArray[np.uint8], function: Callable[[NDArray[np.float64]], NDArray[np.floating]]
) -> NDArray[np.uint8]:
    converted = np.empty_like(srgb)
    for top in range(0, len(srgb), _STRIP):
        rows = slice(top, top + _STRIP)
        converted[rows] = to_uint8(function(srgb[rows] / 255.0))
    return converted
