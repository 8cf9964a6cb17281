"""Photographs whose pigments were multiplied, so that a network learns to follow the skin."""

import torch
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from torch import Tensor

from skinnet.network import F_BLOOD_MAX, F_MEL_MAX, SkinAutoencoder, SkinMaps
from skinnet.physics import to_display

_DARKEST = 2e-3

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch height width"]
Factors = Float[Tensor, "batch 2"]
"""Natural logarithms of the factors on melanin and on hemoglobin."""


@torch.no_grad()
def edit_skin(model: SkinAutoencoder, photograph: Image, mask: Map, factors: Factors) -> Image:
    """Multiply the pigments of skin as the network reads it; all else stays.

    Args:
        model: Reads the photographs, and renders the skin before and after.
        photograph: Display sRGB in [0, 1].
        mask: Probability of skin.
        factors: Log factors of each photograph.

    Returns:
        Display sRGB in [0, 1].
    """
    maps, capture, _ = model.encode(photograph)
    edited = multiply_pigments(maps, factors)
    matrix = model.decoder.camera.matrix(capture)
    before, after = (
        model.decoder.albedo(one.melanin, one.hemoglobin, matrix).clamp_min(_DARKEST)
        for one in (maps, edited)
    )
    linear = rgb_to_linear_rgb(photograph)
    gloss = maps.specular[:, None] * matrix.sum(-2)[..., None, None]
    diffuse = (linear - gloss).clamp_min(0)
    return to_display(linear + mask[:, None] * diffuse * (after / before - 1))


def multiply_pigments(maps: SkinMaps, factors: Factors) -> SkinMaps:
    """Multiply the pigments of maps, up to the largest fractions.

    Args:
        maps: Maps of skin.
        factors: Log factors of each photograph.

    Returns:
        The maps with other pigments.
    """
    melanin, hemoglobin = factors.exp()[..., None, None].unbind(1)
    return maps._replace(
        melanin=(maps.melanin * melanin).clamp_max(F_MEL_MAX),
        hemoglobin=(maps.hemoglobin * hemoglobin).clamp_max(F_BLOOD_MAX),
    )
