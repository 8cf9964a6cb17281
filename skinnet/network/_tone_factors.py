"""Factors on standard deviations by the tone of a face, which are calibrated after training."""

import math

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.network._means import Map, log_mean

_MIDDLE = math.log(0.05)
_TONES = (-1.5, 1.6)
"""Range of tones, melanin of .011 to .25, beyond which factors stay the same."""

Scale = Float[Tensor, "2 2"]
"""Factors at the middle tone: of pixels and of faces, for melanin and hemoglobin each."""

ByTone = Float[Tensor, "2 2 2"]
"""Coefficients of the tone and of its square in the logarithm of each factor."""


def measure_tone(melanin: Map, skin: Map) -> Float[Tensor, "batch"]:
    """Measure the natural logarithm of the mean melanin of skin, relative to .05."""
    return (log_mean(melanin, skin) - _MIDDLE).clamp(*_TONES)


def find_factors(
    tone: Float[Tensor, "count"], scale: Scale, by_tone: ByTone
) -> Float[Tensor, "2 2 count"]:
    """Find the factors on standard deviations of pixels and faces, for each pigment."""
    linear, square = by_tone[..., None].unbind(2)
    return scale[..., None] * (linear * tone + square * tone**2).exp()


def find_range(scale: Scale, by_tone: ByTone) -> tuple[Scale, Scale]:
    """Find the smallest and largest factors over all tones."""
    linear, square = by_tone.unbind(2)
    turning = (-linear / (2 * square)).nan_to_num().clamp(*_TONES)
    tones = torch.stack([*map(torch.full_like, [scale] * 2, _TONES), turning])
    exponents = linear * tones + square * tones**2
    return scale * exponents.amin(0).exp(), scale * exponents.amax(0).exp()
