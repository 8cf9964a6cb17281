"""Skin and what covers it, painted on the charts of a batch of faces."""

from functools import cache
from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.painting.facial_hair import (
    cover_with_beard,
    cover_with_brows,
    cover_with_lashes,
    evaluate_gaussian,
)
from train.synthetic.painting.style_painting import (
    Layer,
    even_out,
    grow_beard,
    has_style,
    list_styled_layers,
)
from train.synthetic.scene import (
    CHART_SIZE,
    FaceParameters,
    FeatureParameters,
    HairParameters,
    MarkParameters,
    PigmentParameters,
)
from train.synthetic.tensors import expand_colour, expand_scalar, soft_step

_REGIONS = ((0.0, 0.50, 0.50, 0.20), (0.52, -0.28, 0.20, 0.15), (0.0, -0.30, 0.14, 0.14),
            (0.34, 0.05, 0.16, 0.10), (0.0, -0.66, 0.17, 0.055),
            (0.0, -1.0, 0.3, 0.15))  # fmt: skip
"""Azimuth, elevation and widths of forehead, cheeks, nose, eyelids, lips and chin."""

_KEPT_STRUCTURE = 0.4
"""Share of the sampled regions and noise that is kept under a skin of a hybrid model, which has
such structure already."""

_Map = Float[Tensor, "batch 1 rows columns"]


class FaceCharts(NamedTuple):
    """A batch of painted faces on their charts.

    `melanin` and `hemoglobin` are volume fractions. `cover_colour` is the linear sRGB of what
    covers the skin, `cover` its opacity. `oil` is relative to that of the picture. `bump`
    holds the gradients of the skin's relief.
    """

    melanin: _Map
    hemoglobin: _Map
    cover_colour: Float[Tensor, "batch 3 rows columns"]
    cover: _Map
    oil: _Map
    bump: Float[Tensor, "batch 2 rows columns"]


def paint_face(face: FaceParameters) -> FaceCharts:
    """Paint skin and what covers it.

    Args:
        face: Parameters of a batch.

    Returns:
        Charts of `CHART_SIZE` rows and columns; the first row is the top.
    """
    skin, device = face.skin, face.skin.bump.device
    azimuth, elevation = (axis.to(device) for axis in compute_chart_angles(*CHART_SIZE))
    regions = _evaluate_regions(device)
    melanin, hemoglobin = _spread_pigments(face, regions)
    colour, cover = torch.cat([torch.zeros_like(melanin)] * 3, 1), torch.zeros_like(melanin)
    layers = _list_layers(face.hair, face.features, azimuth, elevation, regions)
    bump = skin.bump
    oil = (0.8 + 0.7 * regions[2] + 0.5 * regions[0])[None, None].expand_as(cover)
    if has_style(face):
        beard = grow_beard(face)
        layers = list_styled_layers(face, layers, beard)
        bump, oil = bump.clone(), oil.clone()
        bump[beard.faces] *= 1 + 3 * beard.opacity
        oil[beard.faces] *= 1 - 0.7 * beard.opacity
    for layer in layers:
        colour, cover = _put_on(colour, cover, layer)
    return FaceCharts(melanin, hemoglobin, colour / cover.clamp_min(1e-3), cover, oil, bump)


def _put_on(colour: Tensor, cover: Tensor, layer: Layer) -> tuple[Tensor, Tensor]:
    paint, opacity, faces = layer
    if faces is None:
        return colour * (1 - opacity) + paint * opacity, cover + opacity - cover * opacity
    under = cover[faces]
    colour[faces] = colour[faces] * (1 - opacity) + paint * opacity
    cover[faces] = under + opacity - under * opacity
    return colour, cover


@cache
def _evaluate_regions(device: torch.device) -> Float[Tensor, "regions rows columns"]:
    azimuth, elevation = (axis.to(device) for axis in compute_chart_angles(*CHART_SIZE))
    return torch.stack([evaluate_gaussian(azimuth, elevation, *place) for place in _REGIONS])


def _spread_pigments(
    face: FaceParameters, regions: Float[Tensor, "regions rows columns"]
) -> tuple[_Map, _Map]:
    skin, marks = face.skin, face.marks
    kept = 1 - (1 - _KEPT_STRUCTURE) * expand_scalar(skin.has_model_skin)
    log_melanin, log_hemoglobin = (
        kept * sum_structure(pigment, regions) + pigment.model_skin
        for pigment in (skin.melanin, skin.hemoglobin)
    )
    if has_style(face):
        log_melanin, log_hemoglobin = even_out(face.cosmetics, log_melanin, log_hemoglobin)
    # Lips have neither freckles nor moles.
    outside = 1 - regions[4]
    dark = (resize_to_chart(marks.freckles) + paint_moles(marks)) * outside
    vessels = resize_to_chart(marks.vessels) * (regions[1] + regions[2])
    red = (resize_to_chart(marks.spots) + vessels) * outside
    melanin = expand_scalar(skin.melanin.fraction) * (log_melanin + dark).exp()
    hemoglobin = expand_scalar(skin.hemoglobin.fraction) * (log_hemoglobin + red).exp()
    return melanin.clamp(1e-4, F_MEL_MAX), hemoglobin.clamp(1e-4, F_BLOOD_MAX)


def sum_structure(
    pigment: PigmentParameters, regions: Float[Tensor, "regions rows columns"]
) -> _Map:
    """Sum the log factors of regions and of noise."""
    log = torch.einsum("br,rhw->bhw", pigment.regions, regions)[:, None]
    for octave in (pigment.coarse, pigment.middle, pigment.fine):
        log = log + resize_to_chart(octave)
    return log


def resize_to_chart(
    noise: Float[Tensor, "batch channels rows columns"],
) -> Float[Tensor, "batch channels {CHART_SIZE[0]} {CHART_SIZE[1]}"]:
    """Interpolate coarse noise over the whole chart."""
    return F.interpolate(noise, CHART_SIZE, mode="bilinear")


def paint_moles(marks: MarkParameters, flattening: float = 1.0) -> _Map:
    """Paint log factors of all moles on the chart; flat ones are wider than high."""
    azimuth, elevation = (axis.to(marks.moles.device) for axis in compute_chart_angles(*CHART_SIZE))
    centre, height, radius, factor = (part[..., None, None] for part in marks.moles.unbind(2))
    across = torch.exp(-(((azimuth - centre) / radius) ** 2) / 2)
    along = torch.exp(-(((elevation - height) / (flattening * radius)) ** 2) / 2)
    # The Gaussians are separable: two small matrix products paint all of them.
    return torch.matmul((factor * along)[..., 0].mT, across[:, :, 0])[:, None]


def _list_layers(
    hair: HairParameters,
    features: FeatureParameters,
    azimuth: Tensor,
    elevation: Tensor,
    regions: Float[Tensor, "regions rows columns"],
) -> list[Layer]:
    """What lies on the skin, from the skin outwards."""
    side = azimuth.abs()
    hair_colour = expand_colour(hair.colour) * resize_to_chart(hair.strands).exp()
    dark = torch.tensor([0.03, 0.010, 0.008], device=side.device)[None, :, None, None]
    mouth = torch.exp(-(((elevation + 0.66) / 0.010) ** 2)) * soft_step(0.20 - side, 0.04)
    nostrils = evaluate_gaussian(azimuth, elevation, 0.075, -0.435, 0.028, 0.015)
    lips = (1.6 * regions[4]).clamp_max(1) * expand_scalar(features.make_up)
    return [
        Layer(expand_colour(features.lipstick), lips),
        Layer(hair_colour, cover_with_beard(hair.beard, side, elevation)),
        Layer(hair_colour, cover_with_brows(hair, side, elevation)),
        Layer(torch.full_like(dark, 0.015), cover_with_lashes(hair, side, elevation)),
        Layer(dark, 0.5 * mouth),
        Layer(dark, 0.8 * nostrils),
    ]
