"""Skin in pictures without a face: hands, arms, and patches close up."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images._connected_parts import keep_large, label_parts
from skinnet.images._guided_filter import enlarge_guided
from skinnet.images._skin_colours import (
    compute_features,
    fit_normal,
    measure_distance,
    measure_usual_squares,
    step_down,
)
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear

_SIZE = 320
"""Longer side in pixels at which skin is segmented."""

_MOST_DISTANT, _DISTANCE_WIDTH = 3.4, 0.35
"""Mahalanobis distance to the skins of all people at which half is still skin, and the width of
the step; 99 % of the portraits are within 3.5."""

_OWN_DISTANCE = 3.2
"""Mahalanobis distance to the picture's own skin at which half is still skin."""

_SHADING = np.diag([0.0, 0.0, 0.4**2])
"""Covariance that is added for shading: hands and arms have more of it than the front of a face."""

_LEAST_PART = 0.05
"""Least area of a part in areas of the largest one, and of the largest one in that of a picture."""

_RADIUS, _EPSILON = 4, 1e-3


def segment_bare_skin(photo: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Segment skin by its colour in a picture without a face.

    The largest area with colours of skin, under the light and the white balance of usual
    photographs, gives the colours of this picture's skin. Wood, beige walls and cloth may have the
    same colours, and are taken for skin then.

    Args:
        photo: uint8 sRGB [H, W, 3].

    Returns:
        Probability of skin, float32 [H, W] in [0, 1]; 0 everywhere, if nothing has colours of skin.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images._bare_skin import segment_bare_skin
        >>> cheek = astronaut()[120:150, 235:250]
        >>> bool(segment_bare_skin(cheek).mean() > 0.9)
        True
    """
    scale = min(1, _SIZE / max(photo.shape[:2]))
    height, width = (max(1, round(side * scale)) for side in photo.shape[:2])
    small = resize(photo, width, height)
    linear = ndimage.gaussian_filter(srgb_to_linear(small) + np.float32(1e-3), (1, 1, 0))
    probability = _segment(linear)
    if not probability.any():
        return np.zeros(photo.shape[:2], np.float32)
    return enlarge_guided(photo, probability, _RADIUS, _EPSILON)


def _segment(linear: NDArray[Any]) -> NDArray[np.float32]:
    """Probability of skin in linear sRGB [h, w, 3]."""
    features = compute_features(linear)
    distance = np.sqrt(measure_usual_squares(features[..., :2]))
    usual = step_down(distance, _MOST_DISTANT, _DISTANCE_WIDTH)
    seeds = _find_largest(usual > 0.5)
    if seeds.mean() < _LEAST_PART:
        return np.zeros(usual.shape, np.float32)
    mean, covariance = fit_normal(features[seeds])
    distance = measure_distance(linear, mean, covariance + _SHADING)
    own = step_down(distance, _OWN_DISTANCE, 0.35)
    return _clean(own * np.sqrt(usual))


def _find_largest(area: NDArray[np.bool_]) -> NDArray[np.bool_]:
    labels, sizes = label_parts(ndimage.binary_opening(area, iterations=2))
    largest: NDArray[np.bool_] = (labels == sizes.argmax()) & (labels > 0)
    return largest


def _clean(score: NDArray[Any]) -> NDArray[np.float32]:
    """Keep the large parts, and close their small holes."""
    large = keep_large(ndimage.binary_opening(score > 0.5, iterations=2), _LEAST_PART)
    closed = ndimage.binary_closing(np.pad(large, 4, mode="edge"), iterations=3)[4:-4, 4:-4]
    near = ndimage.binary_dilation(large | closed, iterations=2)
    return np.where(closed, np.maximum(score, 0.5 + score / 2), score * near).astype(np.float32)
