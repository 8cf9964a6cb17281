"""Cloth over the mouth: a face mask of any colour hides the line between the lips."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.faces._face_zones import FaceZones, grow

_LEAST_EYES = 0.6
"""Contrast (in log luminance) of eyes and brows below which a picture is too blurred to judge."""

_LEAST_SHARE = 0.06
"""Contrast of lips or nostrils, in that of eyes and brows, below which they are hidden. The least
of 87 bare faces is 0.31 for lips and 0.24 for nostrils; plain cloth mostly has 0.02."""


def find_cover(log: NDArray[Any], zones: FaceZones, side: float) -> NDArray[np.bool_]:
    """Find what a face mask hides, [h, w]; nothing if the mouth is seen.

    A mask with a pattern, or with strong folds, is not found.

    Args:
        log: Log luminance [h, w].
        zones: The parts of the face.
        side: Side of the face's box in pixels.
    """
    darkness = ndimage.gaussian_filter(log, 0.06 * side) - log
    parts = zones.eyes | zones.brows, grow(zones.lips, 1.0), zones.nostrils
    eyes, lips, nostrils = (
        float(np.percentile(darkness[part], 95)) if part.any() else np.inf for part in parts
    )
    if not _LEAST_EYES < eyes < np.inf or lips > _LEAST_SHARE * eyes:
        return np.zeros(log.shape, np.bool_)
    is_on_nose = nostrils < _LEAST_SHARE * eyes
    return grow(zones.cloth if is_on_nose else zones.beard | zones.lips, 0.02 * side)
