"""The individual typology angle of tensors of colours; `skinnet.inference` has its definition."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.inference import _index_definitions as definitions
from skinnet.physics import srgb_to_xyz

GROUPS = definitions.TYPOLOGY_GROUPS
"""Lower ends of the groups in degrees."""


def compute_typology_angle(linear: Float[Tensor, "*shape 3"]) -> Float[Tensor, "*shape"]:
    """Compute atan2(L* - 50, b*) in degrees, of linear sRGB whose white is D65."""
    return torch.from_numpy(definitions.compute_typology_angle(srgb_to_lab(linear).numpy()))


def srgb_to_lab(linear: Float[Tensor, "*shape 3"]) -> Float[Tensor, "*shape 3"]:
    """Convert linear sRGB to CIE 1976 L*a*b* relative to D65."""
    to_xyz = srgb_to_xyz()
    relative = linear.detach().to(to_xyz) @ to_xyz.mT / to_xyz.sum(-1)
    return torch.from_numpy(definitions.compute_lab(relative.numpy()))


def find_group(angle: float) -> str:
    """Return the name of the group of an angle."""
    return definitions.find_typology_group(float(angle))
