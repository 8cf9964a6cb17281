"""RAW files of known spectra and of known pictures, and what they should be read as.

The truth is computed by `oracle`, which imports nothing of the package.
"""

import numpy as np
import oracle
from numpy.typing import NDArray

from tools.dng import Sensor, write_dng

PATCH = 16
"""Width of a patch in pixels; the colours of its middle are not mixed with those of others."""

GAINS = np.array([0.5, 1.0, 0.7])
"""Sensitivity of the channels of a sensor; measured ones are relative."""

EXIF_NAMES = {
    "Nikon D700": ("NIKON CORPORATION", "NIKON D700"),
    "Sony ILCE-7M3": ("SONY", "ILCE-7M3"),
    "Canon EOS 5D Mark IV": ("Canon", "Canon EOS 5D Mark IV"),
}

Array = NDArray[np.float64]


def light(name: str) -> Array:
    return oracle.daylight(6504) if name == "D65" else oracle.columns("illuminants")[name]


def sensitivity(camera: str) -> Array:
    curves = oracle.measured_cameras()[camera]
    return curves / curves.sum(0) * GAINS


def describe(camera: str, power: Array, **stated: object) -> Sensor:
    """What a camera writes of itself: the white of the light, and a matrix that is right for white.

    Its other colours are those of a sensor without crosstalk, so that the file's own matrix is not
    what makes colours right.
    """
    curves = sensitivity(camera)
    daylight = oracle.daylight(6504) @ curves
    rows = np.linalg.inv(oracle.srgb_to_xyz()) * (daylight / daylight.max())[:, None]
    make, model = EXIF_NAMES[camera]
    white = power @ curves
    values = {"neutral": white / white.max(), "matrix": rows} | stated
    return Sensor(make, model, **values)


def photograph_spectra(
    spectra: Array, camera: str, power: Array, exposure: float = 0.8, **stated: object
) -> tuple[bytes, Array]:
    """Photograph patches of known spectra [n, 33] side by side.

    Returns:
        A DNG in which a white patch has `exposure` of a full sensor, and the linear sRGB [n, 3]
        that the patches should have.
    """
    curves = sensitivity(camera)
    white = power @ curves
    values = exposure * (spectra * power) @ curves / white.max()
    pixels = np.repeat(np.repeat(values[None], 3 * PATCH, 0), PATCH, 1)
    truth = exposure * oracle.linear_srgb(spectra, power, oracle.measured_cameras()[camera])
    return write_dng(pixels, describe(camera, power, **stated)), truth


def read_patches(linear: Array) -> Array:
    """The colours [n, 3] in the middle of patches side by side."""
    return linear[len(linear) // 2, PATCH // 2 :: PATCH]


def photograph_picture(linear: Array, camera: str, **stated: object) -> bytes:
    """Photograph a picture in linear sRGB [H, W, 3] as its camera would record it under D65."""
    curves, power = oracle.measured_cameras()[camera], oracle.daylight(6504)
    white = power @ curves
    to_srgb = np.linalg.inv(oracle.srgb_to_xyz()) @ oracle.camera_to_xyz(curves / white)
    balanced = (linear @ np.linalg.inv(to_srgb).T).clip(0)
    white = power @ sensitivity(camera)
    return write_dng(balanced * white / white.max(), describe(camera, power, **stated))
