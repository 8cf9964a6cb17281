"""Opacity of beard, brows and lashes on the charts of a batch of faces."""

import torch
from torch import Tensor

from train.synthetic.scene import BeardParameters, HairParameters
from train.synthetic.tensors import expand_scalar, soft_step


def evaluate_gaussian(
    azimuth: Tensor, elevation: Tensor, centre: float, height: float, width: float, tall: float
) -> Tensor:
    """Evaluate a Gaussian on both sides of the face, or on its middle line.

    Args:
        azimuth: In radians.
        elevation: In radians.
        centre: Azimuth of the maximum; 0 gives one maximum, any other value gives two.
        height: Elevation of the maximum.
        width: Standard deviation in azimuth.
        tall: Standard deviation in elevation.

    Returns:
        Values in [0, 1].

    Example:
        >>> place = torch.tensor([0.5, -0.5, 0.0])
        >>> evaluate_gaussian(place, torch.zeros(3), 0.5, 0.0, 0.1, 0.1)
        tensor([1.0000e+00, 1.0000e+00, 3.7267e-06])
    """
    across = (azimuth.abs() - centre if centre else azimuth) / width
    return torch.exp(-(across**2 + ((elevation - height) / tall) ** 2) / 2)


def cover_with_beard(beard: BeardParameters, side: Tensor, elevation: Tensor) -> Tensor:
    """Find the opacity of beard, moustache and stubble.

    Args:
        beard: What grows on each face.
        side: Distance from the face's middle line in radians.
        elevation: In radians.

    Returns:
        Opacity in [0, 1], [batch, 1, rows, columns].
    """
    jaw = soft_step(-0.42 - elevation - 0.35 * (1 - (side / 0.6).clamp(0, 1)) * (side > 0.25), 0.06)
    lip = soft_step(elevation + 0.60, 0.03) * soft_step(0.35 - side, 0.05)
    jaw = jaw * (1 - lip * (1 - expand_scalar(beard.moustache)))
    lips = evaluate_gaussian(side, elevation, 0.0, -0.66, 0.16, 0.06)
    opacity = jaw * (1 - lips).clamp(0, 1) * soft_step(1.4 - side, 0.1)
    opacity = opacity * soft_step(elevation + 1.25, 0.1)
    hairs = 0.8 + 0.2 * beard.grain
    longest = torch.maximum(expand_scalar(beard.stubble), expand_scalar(beard.beard))
    return opacity * longest * hairs


def cover_with_brows(hair: HairParameters, side: Tensor, elevation: Tensor) -> Tensor:
    """Find the opacity of the brows; arguments as in `cover_with_beard`."""
    height, slope, thickness = (expand_scalar(part) for part in hair.brow_shape.unbind(1))
    arch = elevation - (0.19 + height + (0.05 + slope) * (side - 0.1))
    arch = arch + 0.35 * (side - 0.35).clamp_min(0) ** 2
    length = soft_step(side - 0.12, 0.03) * soft_step(0.58 - side, 0.04)
    return expand_scalar(hair.brow) * length * torch.exp(-((arch / (0.032 + thickness)) ** 2))


def cover_with_lashes(hair: HairParameters, side: Tensor, elevation: Tensor) -> Tensor:
    """Find the opacity of the upper lashes; arguments as in `cover_with_beard`."""
    lid = elevation - (0.055 - 1.6 * (side - 0.34) ** 2)
    length = soft_step(0.15 - (side - 0.34).abs(), 0.03)
    return 0.7 * expand_scalar(hair.lashes) * length * torch.exp(-((lid / 0.014) ** 2))
