"""What becomes of the offset of a texture when its pigments are edited."""

import numpy as np
from jaxtyping import Float32

_DARKEST = np.float32(1e-6)
"""Linear R, G or B below which a channel is as good as black."""


def compute_offset_factor(
    before: Float32[np.ndarray, "*texels"], after: Float32[np.ndarray, "*texels"]
) -> Float32[np.ndarray, "*texels"]:
    """Compute the factors of offsets: an offset darkens with the skin and never grows.

    Args:
        before: Linear RGB of the skin without its offset.
        after: The same after an edit.

    Returns:
        The ratio of the two, at most 1.
    """
    ratio = np.maximum(after, _DARKEST) / np.maximum(before, _DARKEST)
    return np.asarray(ratio.clip(0, 1), np.float32)
