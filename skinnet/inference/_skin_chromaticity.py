"""The colour of skin in a photograph, apart from its brightness."""

import math

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import srgb_to_linear
from skinnet.inference.decomposition import SKIN_THRESHOLD

_MOST_PIXELS = 1 << 18
"""Of larger photographs, every second pixel is looked at, or every third, and so on."""

_DARKEST = 1e-4


def measure_chromaticity(
    photo: NDArray[np.uint8], mask: NDArray[np.float32]
) -> tuple[float, float] | None:
    """Measure log R/G and log B/G of the mean colour of skin in linear sRGB.

    Args:
        photo: uint8 sRGB [H, W, 3].
        mask: Probability of skin [H, W].

    Returns:
        Both natural logarithms; None without skin.
    """
    step = max(1, math.isqrt(mask.size // _MOST_PIXELS))
    skin = mask[::step, ::step] > SKIN_THRESHOLD
    if not skin.any():
        return None
    colours = srgb_to_linear(photo[::step, ::step][skin])
    red, green, blue = np.log(np.maximum(colours.mean(0, dtype=float), _DARKEST)).tolist()
    return red - green, blue - green
