"""sRGB and linear sRGB (IEC 61966-2-1)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)
"""Weights of linear R, G and B in luminance."""


def srgb_to_linear(srgb: NDArray[Any]) -> NDArray[np.float32]:
    """Convert sRGB to linear sRGB.

    Args:
        srgb: uint8, or floats in [0, 1], of any shape.

    Returns:
        Linear sRGB in [0, 1], of the same shape.

    Source:
        IEC 61966-2-1.

    Example:
        >>> import numpy as np
        >>> from skinnet.images import srgb_to_linear
        >>> [round(float(v), 4) for v in srgb_to_linear(np.array([0, 128, 255], np.uint8))]
        [0.0, 0.2159, 1.0]
    """
    if srgb.dtype == np.uint8:
        return np.take(srgb_to_linear(np.arange(256, dtype=np.float32) / 255), srgb)
    value = np.asarray(srgb, np.float32)
    curve = ((np.maximum(value, 0) + 0.055) / 1.055) ** 2.4
    return np.where(value <= 0.04045, value / 12.92, curve).astype(np.float32)


def linear_to_srgb(linear: NDArray[Any]) -> NDArray[np.float32]:
    """Convert linear sRGB to sRGB, clipped to [0, 1].

    Args:
        linear: Floats of any shape.

    Returns:
        sRGB in [0, 1], of the same shape.

    Source:
        IEC 61966-2-1.

    Example:
        >>> import numpy as np
        >>> from skinnet.images import linear_to_srgb
        >>> (255 * linear_to_srgb(np.array([0, 0.2159, 2.0]))).round().tolist()
        [0.0, 128.0, 255.0]
    """
    value = np.clip(np.asarray(linear, np.float32), 0, 1)
    curve = 1.055 * value ** (1 / 2.4) - 0.055
    return np.where(value <= 0.0031308, value * 12.92, curve).astype(np.float32)


def to_uint8(srgb: NDArray[Any]) -> NDArray[np.uint8]:
    """Round sRGB in [0, 1] to uint8; values outside are clipped.

    Args:
        srgb: Floats of any shape.

    Returns:
        uint8 of the same shape.

    Example:
        >>> import numpy as np
        >>> from skinnet.images import to_uint8
        >>> to_uint8(np.array([-0.1, 0.5, 1.0])).tolist()
        [0, 128, 255]
    """
    value: NDArray[np.uint8] = np.rint(np.clip(srgb, 0, 1) * 255).astype(np.uint8)
    return value
