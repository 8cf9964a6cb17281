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
"""Kelvin of the daylight that is white, and of the daylights that pictures are adapted to."""


def apply_gain(photograph: Photograph, gain: NDArray[np.float64]) -> Photograph:
    """Multiply linear light by a gain for each channel; the result is clipped to 8 bits."""
    return to_uint8(linear_to_srgb(srgb_to_linear(photograph) * gain.astype(np.float32)))


def compute_gain(temperature: float) -> NDArray[np.float64]:
    """Compute gains of R, G and B that adapt the white of 6,500 K to another daylight.

    The adaptation is von Kries' in linear sRGB, at the same luminance.
    """
    return (_compute_white(temperature) / _compute_white(NEUTRAL)).numpy()


def _compute_white(temperature: float) -> torch.Tensor:
    xyz = load_light(f"D{temperature:g}K") @ load_observer()
    return torch.linalg.solve(srgb_to_xyz(), xyz / xyz[1])


def compress(photograph: Photograph, quality: int = QUALITY) -> Photograph:
    """Compress as JPEG, with chroma at half size."""
    stream = BytesIO()
    Image.fromarray(photograph).save(stream, "JPEG", quality=quality, subsampling="4:2:0")
    return np.array(Image.open(stream))


def halve(photograph: Photograph) -> Photograph:
    """Halve width and height."""
    height, width = photograph.shape[:2]
    return resize(photograph, max(1, width // 2), max(1, height // 2))


def mirror(photograph: Photograph) -> Photograph:
    """Exchange left and right."""
    return np.ascontiguousarray(photograph[:, ::-1])


DISTURBANCES: dict[str, Callable[[Photograph], Photograph]] = {
    "exposure_up": partial(apply_gain, gain=np.full(3, 2.0)),
    "exposure_down": partial(apply_gain, gain=np.full(3, 0.5)),
    "cooler": partial(apply_gain, gain=compute_gain(COOLER)),
    "warmer": partial(apply_gain, gain=compute_gain(WARMER)),
    "jpeg_40": compress,
    "half_size": halve,
    "mirror": mirror,
}

MIRRORED = ("mirror",)
"""Disturbances after which maps are mirrored back."""
