"""Connected parts of an area of pixels."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_Mask = NDArray[np.bool_]


def label_parts(area: _Mask) -> tuple[NDArray[Any], NDArray[np.intp]]:
    """Label the connected parts of an area [h, w], from 1, and count the pixels of each label.

    What is outside has label 0, whose count is given as 0.
    """
    labels, count = ndimage.label(area)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    sizes[0] = 0
    return labels, sizes


def keep_small(area: _Mask, largest: float) -> _Mask:
    """Keep the parts that are smaller than a number of pixels."""
    labels, sizes = label_parts(area)
    kept: _Mask = (sizes < largest)[labels] & area
    return kept


def keep_large(area: _Mask, least_share: float) -> _Mask:
    """Keep the parts that are larger than a share of the largest one."""
    labels, sizes = label_parts(area)
    kept: _Mask = (sizes > least_share * sizes.max())[labels]
    return kept
