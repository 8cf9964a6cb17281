"""Bilinear resizing of photographs and maps."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Pixels = TypeVar("Pixels", NDArray[np.uint8], NDArray[np.float32])


def resize(pixels: Pixels, width: int, height: int) -> Pixels:
    """Resize bilinearly; where the image shrinks, average over all pixels.

    Args:
        pixels: uint8 [H, W, 3] or float32 [H, W].
        width: Columns of the result.
        height: Rows of the result.

    Returns:
        The resized pixels, of the same type.

    Example:
        >>> import numpy as np
        >>> from skinnet.images import resize
        >>> ramp = np.array([[0, 1], [0, 1]], np.float32)
        >>> resize(ramp, 4, 1).tolist()
        [[0.0, 0.25, 0.75, 1.0]]
    """
    image = Image.fromarray(np.ascontiguousarray(pixels))
    return np.array(image.resize((width, height), Image.Resampling.BILINEAR, reducing_gap=3.0))
