"""White balances that are estimated from a photograph alone, as baselines."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8

Photograph = NDArray[np.uint8]
Balance = Callable[[Photograph], Photograph]

MISSING = (
    "OpenCV's learned white balance is in its contributed modules: put "
    "opencv-contrib-python-headless on the path (`pip install --no-deps --target FOLDER`)."
)


def keep(photo: Photograph) -> Photograph:
    """Return the photograph as it is."""
    return photo


def balance_to_grey(photo: Photograph) -> Photograph:
    """Make the mean of all pixels grey, in linear light.

    Source:
        The grey-world assumption, Buchsbaum 1980, doi 10.1016/0016-0032(80)90058-7.
    """
    linear = srgb_to_linear(photo)
    mean = linear.mean((0, 1)).clip(1e-4)
    return to_uint8(linear_to_srgb((linear * (mean.mean() / mean)).clip(0, 1)))


def balance_by_opencv(photo: Photograph) -> Photograph:
    """Balance by OpenCV's learned white balance, with the trees that it ships.

    Source:
        Cheng et al. 2015, doi 10.1109/CVPR.2015.7298702.
    """
    return np.ascontiguousarray(_load_opencv().balanceWhite(photo[..., ::-1].copy())[..., ::-1])


def has_opencv() -> bool:
    """Whether OpenCV's contributed modules are at hand."""
    try:
        _load_opencv()
    except (ImportError, AttributeError):
        return False
    return True


@cache
def _load_opencv() -> Any:
    from cv2 import xphoto

    return xphoto.createLearningBasedWB()


def list_balances() -> dict[str, Balance | None]:
    """List the baselines by name; None for one that is not at hand."""
    return {
        "uncorrected": keep,
        "grey_world": balance_to_grey,
        "learned_white_balance": balance_by_opencv if has_opencv() else None,
    }
