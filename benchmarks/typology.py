"""The individual typology angle, by which dermatology classifies skin by its colour."""

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.physics import srgb_to_xyz

GROUPS = {
    "very_light": 55.0,
    "light": 41.0,
    "intermediate": 28.0,
    "tan": 10.0,
    "brown": -30.0,
    "dark": -180.0,
}
"""Lower ends in degrees (Chardon et al. 1991; Del Bino and Bernerd 2013)."""

_EDGE = 6 / 29


def compute_typology_angle(linear: Float[Tensor, "*shape 3"]) -> Float[Tensor, "*shape"]:
    """Compute atan2(L* - 50, b*) in degrees, of linear sRGB whose white is D65."""
    lightness, _, b = srgb_to_lab(linear).unbind(-1)
    return torch.rad2deg(torch.atan2(lightness - 50, b))


def srgb_to_lab(linear: Float[Tensor, "*shape 3"]) -> Float[Tensor, "*shape 3"]:
    """Convert linear sRGB to CIE 1976 L*a*b* relative to D65 (CIE 015:2018, section 8.2.1)."""
    to_xyz = srgb_to_xyz()
    relative = linear.to(to_xyz) @ to_xyz.mT / to_xyz.sum(-1)
    root = relative.clamp_min(_EDGE**3) ** (1 / 3)
    x, y, z = torch.where(relative > _EDGE**3, root, relative / (3 * _EDGE**2) + 4 / 29).unbind(-1)
    return torch.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], -1)


def find_group(angle: float) -> str:
    """Return the name of the group of an angle."""
    return next(name for name, low in GROUPS.items() if angle > low or name == "dark")
