"""The regions of a face that are followed, as masks in its texture space."""

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._face_regions import locate_region

REGIONS = ("forehead", "left_cheek", "right_cheek", "nose", "lips", "chin")
"""Left and right are the person's."""

FACE = "face"
"""All regions but the lips together, whose skin is alike."""

NAMES = (FACE, *REGIONS)


def mark_regions(landmarks: NDArray[np.floating], size: int) -> NDArray[np.bool_]:
    """Mark the regions in a texture.

    Args:
        landmarks: Columns and rows [478, 2] in texels.
        size: Side of the texture.

    Returns:
        Masks in the order of `NAMES`, [regions, size, size].
    """
    masks = np.zeros((len(NAMES), size, size), np.bool_)
    for mask, name in zip(masks[1:], REGIONS, strict=True):
        patch = locate_region(landmarks.astype(np.float32), name).clip(size, size)
        mask[patch.box.slices] = patch.inside
    lips = NAMES.index("lips")
    masks[0] = np.delete(masks, (0, lips), 0).any(0)
    return masks
