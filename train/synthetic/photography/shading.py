"""Diffuse shading and specular reflection on the buffers of a batch of heads."""

from typing import NamedTuple

import torch
from jaxtyping import Float, Int
from torch import Tensor

from train.synthetic.casts.directions import LIGHT_DIRECTIONS
from train.synthetic.scene import LightParameters, SpecularParameters
from train.synthetic.tensors import expand_colour, expand_scalar

_NEAREST = 5
"""Directions that stand for one lamp. A lamp is an area, so that shadows have soft edges."""

_F0 = 0.028
"""Reflectance of skin at normal incidence, from an index of refraction of 1.4."""

Map = Float[Tensor, "batch 1 height width"]


class Shading(NamedTuple):
    """Diffuse shading and specular reflection, relative to a white diffuser facing the light.

    `tint` is the colour of the light in linear sRGB, with a green of about 1; None: white.
    """

    diffuse: Map
    specular: Map
    tint: Float[Tensor, "batch 3 height width"] | None = None


def shade(
    light: LightParameters,
    specular: SpecularParameters,
    normal: Float[Tensor, "batch 3 height width"],
    sky_visibility: Map,
    visibility_mask: Int[Tensor, "batch height width"],
    oil: Map,
) -> Shading:
    """Shade surfaces by a sky and by lamps that cast shadows.

    Args:
        light: Sky and lamps.
        specular: Oil and roughness of each picture's skin.
        normal: Unit normals in the camera's axes.
        sky_visibility: Share of the sky that nothing hides, in [0, 1].
        visibility_mask: A bit for each of `LIGHT_DIRECTIONS`, as in `HeadBuffers`.
        oil: Oil of each pixel relative to its picture's.

    Returns:
        Both kinds of light, relative to a white diffuser facing the light.

    Source:
        Lobe of Blinn and Phong, Fresnel term of Schlick.
    """
    sky = _shade_sky(light.sky, normal).clamp_min(0.03) * sky_visibility
    diffuse, lobes = sky, torch.zeros_like(sky)
    sharpness = expand_scalar(2 / specular.roughness**4 - 2)
    sky_tint, *tints = (expand_colour(one) for one in light.tints.exp().unbind(1))
    coloured = sky_tint * sky if light.tints.any() else None
    for lamp, strength, softness, tint in zip(
        *(one.unbind(1) for one in (light.lamps, light.strength, light.softness)),
        tints,
        strict=True,
    ):
        cosine = torch.einsum("bi,bihw->bhw", lamp, normal)[:, None].clamp_min(0)
        visibility = find_lamp_visibility(visibility_mask, lamp, softness)
        irradiance = expand_scalar(strength) * cosine * visibility
        diffuse = diffuse + irradiance
        coloured = None if coloured is None else coloured + tint * irradiance
        lobes = lobes + irradiance * _evaluate_lobe(lamp, normal, sharpness)
    # A rough surface also reflects light from all other directions to the camera.
    lobes = lobes + _reflect_at_rim(normal) * diffuse
    tint = None if coloured is None else coloured / diffuse.clamp_min(1e-4)
    return Shading(diffuse, lobes * expand_scalar(specular.oil) * oil, tint)


def find_lamp_visibility(
    visibility_mask: Int[Tensor, "batch height width"],
    lamp: Float[Tensor, "batch 3"],
    softness: Float[Tensor, "batch"],
) -> Map:
    """Find the share of a lamp that is visible from each pixel.

    Args:
        visibility_mask: A bit for each of `LIGHT_DIRECTIONS`.
        lamp: Unit vector towards the lamp.
        softness: Half width of the lamp in radians.

    Returns:
        Shares in [0, 1].
    """
    directions = torch.from_numpy(LIGHT_DIRECTIONS.copy()).to(lamp)
    cosine, index = (lamp @ directions.T).topk(_NEAREST, dim=1)
    squared_distance = (2 - 2 * cosine).clamp_min(0)
    weight = torch.softmax(-squared_distance / (2 * softness[:, None] ** 2 + 0.02), 1)
    share = torch.zeros_like(visibility_mask, dtype=lamp.dtype)
    for k in range(_NEAREST):
        bit = (visibility_mask >> index[:, k, None, None]) & 1
        share = share + weight[:, k, None, None] * bit
    return share[:, None]


def _shade_sky(sky: Float[Tensor, "batch 9"], normal: Float[Tensor, "batch 3 height width"]) -> Map:
    """Irradiance by spherical harmonics, unnormalised: 1, y, z, x and the second order."""
    x, y, z = normal.unbind(1)
    one = torch.ones_like(x)
    basis = torch.stack([one, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y], 1)
    return torch.einsum("bk,bkhw->bhw", sky, basis)[:, None]


def _reflect_at_rim(normal: Float[Tensor, "batch 3 height width"]) -> Map:
    return _F0 + (1 - _F0) * 0.25 * (1 - normal[:, 2:].clamp(0, 1)) ** 5


def _evaluate_lobe(
    lamp: Float[Tensor, "batch 3"],
    normal: Float[Tensor, "batch 3 height width"],
    sharpness: Float[Tensor, "batch 1 1 1"],
) -> Map:
    half = lamp + lamp.new_tensor([0, 0, 1])
    half = half / half.norm(dim=1, keepdim=True)
    cosine = torch.einsum("bi,bihw->bhw", half, normal)[:, None].clamp_min(1e-4)
    fresnel = _F0 + (1 - _F0) * (1 - expand_scalar(half[:, 2])).clamp_min(0) ** 5
    lobe: Map = (sharpness + 2) / 8 * fresnel * cosine**sharpness
    return lobe
