"""Diffuse light and gloss on the geometry buffers of a batch of heads."""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from train.synthetic.directions import DIRECTIONS
from train.synthetic.tensors import column

NEAREST = 5
"""Directions that stand for one lamp: an area, so that shadows have soft edges."""

F0 = 0.028
"""Reflectance of skin at normal incidence, from an index of refraction of 1.4."""

Map = Float[Tensor, "batch 1 height width"]


class Shade(NamedTuple):
    """Diffuse shading and specular reflection, relative to a white diffuser facing the light."""

    diffuse: Map
    specular: Map


def shade(
    lot: dict[str, Tensor],
    normal: Float[Tensor, "batch 3 height width"],
    openness: Map,
    seen: Int[Tensor, "batch height width"],
    oil: Map,
) -> Shade:
    """Light of the sky and of three lamps with their shadows (Blinn and Phong's lobe, Schlick's
    Fresnel term).

    `seen` holds a bit for each of `DIRECTIONS`, `openness` the share of the sky.
    """
    sky = _sky(lot["sky"], normal).clamp_min(0.03) * openness
    diffuse, lobes = sky, torch.zeros_like(sky)
    sharpness = column(2 / lot["roughness"] ** 4 - 2)
    for lamp, strength, softness in zip(
        lot["lamps"].unbind(1), lot["strength"].unbind(1), lot["softness"].unbind(1), strict=True
    ):
        facing = torch.einsum("bi,bihw->bhw", lamp, normal)[:, None].clamp_min(0)
        light = column(strength) * facing * visible(seen, lamp, softness)
        diffuse = diffuse + light
        lobes = lobes + light * _lobe(lamp, normal, sharpness)
    # The rough share of the surface sends a sky and lamps of any direction to the camera.
    specular = (lobes + _rim(normal) * diffuse) * column(lot["oil"]) * oil
    return Shade(diffuse, specular)


def visible(
    seen: Int[Tensor, "batch height width"],
    lamp: Float[Tensor, "batch 3"],
    softness: Float[Tensor, "batch"],
) -> Map:
    """Share of a lamp of that half width, in radians, that each pixel sees."""
    cosine, index = (lamp @ torch.from_numpy(DIRECTIONS.copy()).to(lamp).T).topk(NEAREST, dim=1)
    apart = (2 - 2 * cosine).clamp_min(0)
    weight = torch.softmax(-apart / (2 * softness[:, None] ** 2 + 0.02), 1)
    share = torch.zeros_like(seen, dtype=lamp.dtype)
    for k in range(NEAREST):
        bit = (seen >> index[:, k, None, None]) & 1
        share = share + weight[:, k, None, None] * bit
    return share[:, None]


def _sky(sky: Float[Tensor, "batch 9"], normal: Float[Tensor, "batch 3 height width"]) -> Map:
    """Irradiance of a sky of nine spherical harmonics, unnormalised: 1, y, z, x and the second
    order."""
    x, y, z = normal.unbind(1)
    one = torch.ones_like(x)
    basis = torch.stack([one, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y], 1)
    return torch.einsum("bk,bkhw->bhw", sky, basis)[:, None]


def _rim(normal: Float[Tensor, "batch 3 height width"]) -> Map:
    return F0 + (1 - F0) * 0.25 * (1 - normal[:, 2:].clamp(0, 1)) ** 5


def _lobe(
    lamp: Float[Tensor, "batch 3"],
    normal: Float[Tensor, "batch 3 height width"],
    sharpness: Float[Tensor, "batch 1 1 1"],
) -> Map:
    half = lamp + lamp.new_tensor([0, 0, 1])
    half = half / half.norm(dim=1, keepdim=True)
    glint = torch.einsum("bi,bihw->bhw", half, normal)[:, None].clamp_min(1e-4)
    fresnel = F0 + (1 - F0) * (1 - column(half[:, 2])).clamp_min(0) ** 5
    lobe: Map = (sharpness + 2) / 8 * fresnel * glint**sharpness
    return lobe
