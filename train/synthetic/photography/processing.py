"""What is done to photographs after the tone curve: flare, grading, resampling, sharpening."""

import torch
import torch.nn.functional as F
from jaxtyping import Float
from kornia.filters import gaussian_blur2d
from torch import Tensor

from skinnet.physics import luminance
from train.synthetic.scene import ProcessingParameters
from train.synthetic.tensors import expand_colour, expand_scalar

_SHARPENED = 5, (1.0, 1.0)
"""Size and standard deviation, in pixels, of the blur whose difference is the fine detail."""

Image = Float[Tensor, "batch 3 height width"]


def add_flare(processing: ProcessingParameters, linear: Image) -> Image:
    """Add stray light to linear light."""
    return linear + expand_scalar(processing.flare) if processing.flare.any() else linear


def grade(processing: ProcessingParameters, display: Image) -> Image:
    """Change saturation, and tone shadows and highlights of display sRGB.

    Args:
        processing: What is done to each picture.
        display: Display sRGB in [0, 1].

    Returns:
        Display sRGB in [0, 1].
    """
    if processing.saturation.any():
        grey = luminance(display)
        display = grey + expand_scalar(processing.saturation.exp()) * (display - grey)
    if processing.toning.any():
        bright = luminance(display).clamp(0, 1)
        shadows, highlights = (expand_colour(one) for one in processing.toning.unbind(1))
        display = display * torch.exp((1 - bright) * shadows + bright * highlights)
    return display.clamp(0, 1)


def resample(processing: ProcessingParameters, display: Image) -> Image:
    """Make pictures smaller and large again, and sharpen them.

    Args:
        processing: What is done to each picture.
        display: Display sRGB in [0, 1].

    Returns:
        Display sRGB in [0, 1].
    """
    size = display.shape[-2:]
    chosen = processing.reduction.nonzero()[:, 0].tolist()
    if chosen:
        display = display.clone()
    for number in chosen:
        scale = float(torch.exp(-processing.reduction[number]))
        small = [max(8, round(scale * side)) for side in size]
        reduced = F.interpolate(display[number, None], small, mode="bilinear", antialias=True)
        display[number] = F.interpolate(reduced, size, mode="bicubic")[0].clamp(0, 1)
    if processing.sharpening.any():
        detail = display - gaussian_blur2d(display, *_SHARPENED)
        display = (display + expand_scalar(processing.sharpening) * detail).clamp(0, 1)
    return display
