"""Changes of a photograph, uint8 sRGB [height, width, 3], that leave the skin as it is."""

from collections.abc import Callable
from functools import partial
from io import BytesIO

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image

from skinnet.images import linear_to_srgb, resize, srgb_to_linear, to_uint8
from skinnet.physics import load_light, load_observer, srgb_to_xyz

Photograph = NDArray[np.uint8]

QUALITY = 40
NEUTRAL, COOLER, WARMER = 6500.0, 7000.0, 6000.0
"""Kelvin of the daylight that is white, and of those that pictures are turned to."""


def gained(photograph: Photograph, gain: NDArray[np.float64]) -> Photograph:
    """Linear light times a gain for each channel, clipped and in 8 bits again."""
    return to_uint8(linear_to_srgb(srgb_to_linear(photograph) * gain.astype(np.float32)))


def balance(temperature: float) -> NDArray[np.float64]:
    """Gains of R, G, B that turn the white of 6,500 K into that of another daylight (von Kries in
    linear sRGB), at the same luminance."""
    return (_white(temperature) / _white(NEUTRAL)).numpy()


def _white(temperature: float) -> torch.Tensor:
    xyz = load_light(f"D{temperature:g}K") @ load_observer()
    return torch.linalg.solve(srgb_to_xyz(), xyz / xyz[1])


def jpeg(photograph: Photograph) -> Photograph:
    """Through a JPEG of that quality, chroma at half size."""
    stream = BytesIO()
    Image.fromarray(photograph).save(stream, "JPEG", quality=QUALITY, subsampling="4:2:0")
    return np.array(Image.open(stream))


def halved(photograph: Photograph) -> Photograph:
    """Half as wide and high."""
    height, width = photograph.shape[:2]
    return resize(photograph, max(1, width // 2), max(1, height // 2))


def mirrored(photograph: Photograph) -> Photograph:
    """Left and right changed."""
    return np.ascontiguousarray(photograph[:, ::-1])


DISTURBANCES: dict[str, Callable[[Photograph], Photograph]] = {
    "exposure_up": partial(gained, gain=np.full(3, 2.0)),
    "exposure_down": partial(gained, gain=np.full(3, 0.5)),
    "cooler": partial(gained, gain=balance(COOLER)),
    "warmer": partial(gained, gain=balance(WARMER)),
    "jpeg_40": jpeg,
    "half_size": halved,
    "mirror": mirrored,
}

UNDONE = ("mirror",)
"""Those after which maps are mirrored back."""
