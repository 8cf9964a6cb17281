"""Conversions of pixels that need no profile."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image


def to_eight_bits(values: NDArray[Any]) -> NDArray[np.uint8]:
    """Round uint16 to uint8; uint8 stays as it is."""
    if values.dtype == np.uint8:
        return values
    return ((values.astype(np.uint32) + 128) // 257).astype(np.uint8)


def guess_rgb(cmyk: NDArray[Any]) -> NDArray[np.uint8]:
    """Convert CMYK pixels [H, W, 4] of unknown inks to RGB, roughly, as viewers do."""
    return np.array(Image.fromarray(to_eight_bits(cmyk), "CMYK").convert("RGB"))
