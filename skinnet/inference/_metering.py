"""Exposure of pictures in linear light: the network sees skin as bright as it learnt to.

A RAW file is not brightened, and the network learnt from pictures that are exposed for the skin. So
its input is metered, and what is relative to the light is scaled back.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import LUMINANCE_WEIGHTS, linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference.decomposition import SKIN_THRESHOLD

_METERED = 0.24
"""Median, over synthetic pictures in linear light, of the mean luminance of skin.

It is 0.18 to 0.33 in nine of ten. At a tenth of the exposure, the RMSE of log melanin of 48 of them
was 0.36 without metering and 0.25, as at the full exposure, with it.
"""

_LARGEST, _LEAST = 32.0, 1.05
"""Largest gain, five stops, and the least that is worth another run of the network."""

_RELATIVE_TO_LIGHT = ("shading", "specular", "offset")

Arrays = Mapping[str, NDArray[np.float32]]


def find_gain(cut: NDArray[np.uint8], mask: NDArray[np.float32], known: Arrays) -> float:
    """Find the gain of linear light that brightens the skin of a cut [h, w, 3] as in training.

    Args:
        cut: The network's input, uint8 sRGB.
        mask: Probability of skin [h, w].
        known: What the network is told of the capture.

    Returns:
        At least 1; 1 for pictures that are not known to be linear.
    """
    skin = mask > SKIN_THRESHOLD
    if not known.get("known_linear", np.zeros(1)).any() or not skin.any():
        return 1.0
    light = float((srgb_to_linear(cut[skin]) @ LUMINANCE_WEIGHTS).mean())
    gain = min(_METERED / max(light, 1e-6), _LARGEST)
    return gain if gain > _LEAST else 1.0


def brighten(photo: NDArray[np.uint8], gain: float) -> NDArray[np.uint8]:
    """Multiply the linear light of uint8 sRGB [H, W, 3]."""
    table = to_uint8(linear_to_srgb(gain * srgb_to_linear(np.arange(256, dtype=np.uint8))))
    return np.take(table, photo)


def shift_exposure(known: Arrays, gain: float) -> dict[str, NDArray[np.float32]]:
    """What is known of the capture of a brightened picture."""
    exposure = known.get("known_exposure")
    if exposure is None:
        return dict(known)
    return dict(known) | {"known_exposure": exposure + np.float32(np.log(gain))}


def scale_back(outputs: Arrays, gain: float) -> dict[str, NDArray[np.float32]]:
    """Make what was read of a brightened picture that of the picture itself."""
    scaled = {name: outputs[name] / np.float32(gain) for name in _RELATIVE_TO_LIGHT}
    return dict(outputs) | scaled
