"""Colours of pixels, and the colour of a face's skin, with which parts of the face are compared."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._outlines import Patch
from skinnet.images.srgb import LUMINANCE_WEIGHTS, srgb_to_linear

_BLACK = np.float32(1e-3)
"""Linear value added before the logarithm."""

_ENOUGH_PIXELS = 10_000
"""Pixels of a patch of which a median is taken; of more, some are left out."""


class Colours(NamedTuple):
    """Colours of pixels, each an array of the same shape.

    Attributes:
        luminance: Relative luminance in [0, 1].
        red: log R/G of linear sRGB.
        blue: log B/G.
    """

    luminance: NDArray[np.float32]
    red: NDArray[np.float32]
    blue: NDArray[np.float32]

    def reduce(self, pixels: NDArray[np.bool_] | slice = slice(None)) -> "Colours":
        """The medians over some pixels."""
        return Colours(*(np.asarray(np.median(values[pixels])) for values in self))


def measure_colours(srgb: NDArray[np.uint8]) -> Colours:
    """Measure the colours of pixels [..., 3]."""
    red, green, blue = np.moveaxis(srgb_to_linear(srgb) + _BLACK, -1, 0)
    weights = LUMINANCE_WEIGHTS
    luminance = weights[0] * red + weights[1] * green + weights[2] * blue
    return Colours(luminance, np.log(red / green), np.log(blue / green))


def measure_skin(photo: NDArray[np.uint8], patches: Iterable[Patch]) -> Colours | None:
    """Median colours of patches of skin within a photograph; None if they have no pixel."""
    samples = []
    for patch in patches:
        pixels = photo[patch.box.slices][patch.inside]
        samples.append(pixels[:: 1 + len(pixels) // _ENOUGH_PIXELS])
    together = np.concatenate(samples)
    return measure_colours(together).reduce() if len(together) else None
