"""Pixels of sclera and teeth: bright, and less red than the skin."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.faces._outlines import Patch
from skinnet.images.faces._skin_reference import Colours, measure_colours

_CLIPPED = 250
"""Stored value from which on a pixel is a highlight."""

_LEAST_CONTRAST = 0.1
"""Least difference of log R/G from the skin."""

_LEAST_LUMINANCE = 0.15
"""Least luminance relative to the skin: chromaticity of darker pixels is noise."""

_LUMINANCES = 0.6, 1.5
"""Range of luminance relative to the median of the brighter half: less is shade, lashes and gaps
between teeth, and more is reflection."""

_SPREAD = 0.12, 0.15
"""Largest differences of log R/G and log B/G from those of the brighter half."""

_LEAST_PIXELS = 6
"""Least pixels of which a median is taken."""


def select_near_white(photo: NDArray[np.uint8], candidates: Patch, skin: Colours) -> Patch:
    """Select the pixels of one near-white colour.

    Args:
        photo: uint8 sRGB [H, W, 3].
        candidates: Pixels of the photograph that may be near white.
        skin: The colour of the skin around them.

    Returns:
        Those of the candidates that are near white; none if hardly any are bright and less red than
        the skin.
    """
    srgb = photo[candidates.box.slices]
    colours = measure_colours(srgb)
    pale = candidates.inside & (srgb.max(-1) < _CLIPPED)
    pale &= colours.red < skin.red - _LEAST_CONTRAST
    pale &= colours.luminance > _LEAST_LUMINANCE * skin.luminance
    if pale.sum() < _LEAST_PIXELS:
        return candidates._replace(inside=np.zeros_like(pale))
    centre = colours.reduce(pale & (colours.luminance >= np.median(colours.luminance[pale])))
    low, high = (limit * centre.luminance for limit in _LUMINANCES)
    chosen = pale & (colours.luminance > low) & (colours.luminance < high)
    chosen &= np.abs(colours.red - centre.red) < _SPREAD[0]
    chosen &= np.abs(colours.blue - centre.blue) < _SPREAD[1]
    return candidates._replace(inside=_drop_specks(chosen))


def _drop_specks(chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Drop pixels that are not in any chosen square of 2 by 2."""
    return np.asarray(ndimage.binary_opening(chosen, np.ones((2, 2), bool)))
