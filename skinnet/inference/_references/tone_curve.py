"""How a photograph differs from linear light: stray light, tone curve, saturation; and back."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import LUMINANCE_WEIGHTS

Array = NDArray[np.float64]

_PIVOT = 0.18
"""Linear value that contrast does not change."""

_STEPS = 2048
_LEAST = 1e-6


class ToneCurve(NamedTuple):
    """A tone curve with the parameters of the training's cameras.

    Attributes:
        contrast: Natural logarithm of the exponent about middle grey.
        bend: Strength of the S-curve in display sRGB; below 1.
        flare: Stray light that is added to linear light.
        saturation: Natural logarithm of the factor on the distance from grey in display sRGB.
    """

    contrast: float = 0.0
    bend: float = 0.0
    flare: float = 0.0
    saturation: float = 0.0

    def apply(self, linear: Array) -> Array:
        """Turn linear light [..., 3] into display sRGB in [0, 1]."""
        lit = np.maximum(linear + self.flare, 0)
        display = self._bend(_encode(_PIVOT * (lit / _PIVOT + _LEAST) ** math.exp(self.contrast)))
        return _saturate(display, self.saturation).clip(0, 1)

    def undo(self, display: Array) -> Array:
        """Turn display sRGB [..., 3] in [0, 1] into linear light."""
        plain = _saturate(display, -self.saturation).clip(0, 1)
        steps = np.linspace(0, 1, _STEPS)
        encoded = np.interp(plain, self._bend(steps), steps)
        lit = _PIVOT * (_decode(encoded) / _PIVOT) ** math.exp(-self.contrast)
        return np.maximum(lit - self.flare, 0)

    def _bend(self, display: Array) -> Array:
        return np.asarray(
            (display + self.bend * display * (1 - display) * (2 * display - 1)).clip(0, 1)
        )


def _saturate(display: Array, saturation: float) -> Array:
    grey = (display @ LUMINANCE_WEIGHTS)[..., None]
    return np.asarray(grey + math.exp(saturation) * (display - grey))


def _encode(linear: Array) -> Array:
    """SRGB's curve in float64, whose derivatives are taken by differences."""
    value = linear.clip(0, 1)
    return np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)


def _decode(display: Array) -> Array:
    curve = ((display + 0.055) / 1.055) ** 2.4
    return np.where(display <= 0.04045, display / 12.92, curve)
