"""Beards, make-up, face paint and plasters on the charts of a batch of faces."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.painting.facial_hair import evaluate_gaussian
from train.synthetic.scene import (
    CHART_SIZE,
    BeardStyleParameters,
    CosmeticParameters,
    FaceParameters,
    map_tensors,
)
from train.synthetic.tensors import expand_colour, expand_scalar, soft_step


class Layer(NamedTuple):
    """Paint on some faces of a batch; None is all of them."""

    colour: Tensor
    opacity: Tensor
    faces: Tensor | None = None


def has_style(face: FaceParameters) -> bool:
    """Tell whether the faces are of the variety `any`, whose cloth is never quite black."""
    return bool(face.garments.colours.any())


def list_styled_layers(face: FaceParameters, layers: list[Layer], beard: Layer) -> list[Layer]:
    """Put make-up under the layers of a mild face, and beard, paint and plaster over them.

    Args:
        face: A batch.
        layers: Layers of a mild face, from the skin outwards. The first two are lipstick, which
            here ends at the lips' edge, and the beard that `beard` replaces.
        beard: Result of `grow_beard`.

    Returns:
        All layers.
    """
    make_up, (azimuth, elevation) = face.cosmetics, _get_angles(beard.colour.device)
    side = azimuth.abs()
    under = [
        _spread(make_up.blush, make_up.blush_colour, _find_cheeks(azimuth, elevation)),
        _spread(make_up.eye_shadow, make_up.eye_shadow_colour, _find_lids(azimuth, elevation)),
        _spread(face.features.make_up, face.features.lipstick, _find_lips(side, elevation)),
    ]
    black = torch.full_like(make_up.paint_colour, 0.012)
    return [
        *under,
        *layers[2:],
        _spread(make_up.eyeliner, black, _line_eyes(side, elevation)),
        beard,
        _paint(make_up, azimuth, elevation),
        _stick_plaster(make_up, azimuth, elevation),
    ]


def grow_beard(face: FaceParameters) -> Layer:
    """Paint beard and stubble on the faces that have some."""
    grown = (face.beard_style.beard + face.beard_style.stubble).nonzero()[:, 0]
    style = map_tensors(lambda value: value[grown], face.beard_style)
    azimuth, elevation = _get_angles(grown.device)
    hairs = expand_colour(style.colour) * (0.4 * _resize(style.hairs)).exp()
    return Layer(hairs, cover_with_style(style, azimuth.abs(), elevation), grown)


def _spread(opacity: Tensor, colour: Tensor, place: Tensor) -> Layer:
    """Spread one colour over a place of the faces whose opacity is not 0."""
    worn = opacity.nonzero()[:, 0]
    return Layer(expand_colour(colour[worn]), expand_scalar(opacity[worn]) * place, worn)


def _get_angles(device: torch.device) -> tuple[Tensor, Tensor]:
    azimuth, elevation = compute_chart_angles(*CHART_SIZE)
    return azimuth.to(device), elevation.to(device)


def even_out(
    make_up: CosmeticParameters, log_melanin: Tensor, log_hemoglobin: Tensor
) -> tuple[Tensor, Tensor]:
    """Let foundation hide the structure of the pigments; the skin under it stays skin.

    Args:
        make_up: Of each face.
        log_melanin: Log factors of melanin over the chart.
        log_hemoglobin: The same of hemoglobin.

    Returns:
        Log factors as they seem to be.
    """
    azimuth, elevation = _get_angles(log_melanin.device)
    face = soft_step(1.15 - azimuth.abs(), 0.2) * soft_step(elevation + 1.1, 0.1)
    share = expand_scalar(make_up.foundation) * face * soft_step(0.7 - elevation, 0.1)
    tone = expand_scalar(make_up.foundation_tone)
    return log_melanin * (1 - share) + tone * share, log_hemoglobin * (1 - share)


def cover_with_style(style: BeardStyleParameters, side: Tensor, elevation: Tensor) -> Tensor:
    """Find the opacity of beard and stubble, whose edges are as irregular as hairs are.

    Args:
        style: What grows on each face.
        side: Distance from the face's middle line in radians.
        elevation: In radians.

    Returns:
        Opacity in [0, 1], [batch, 1, rows, columns].
    """
    hairs = _resize(style.hairs).clamp(-2, 2)
    height = elevation + 0.035 * _resize(style.edge)
    lips = evaluate_gaussian(side, elevation, 0.0, -0.667, 0.17, 0.052)
    bare = 1 - (1.25 * lips).clamp_max(1)
    parts = _find_parts(style, side, height)
    empty = torch.ones_like(parts[0])
    for share, part in zip(style.parts.unbind(1), parts, strict=True):
        empty = empty * (1 - expand_scalar(share) * part)
    shape = (1 - empty) * bare
    grown = soft_step(shape + 0.09 * hairs - 0.5, 0.28) * (5 * shape).clamp_max(1)
    everywhere = 1 - (1 - parts[0]) * (1 - parts[1]) * (1 - parts[2]) * (1 - parts[3])
    stubble = expand_scalar(style.stubble) * everywhere * bare * (0.85 + 0.12 * hairs)
    beard = expand_scalar(style.beard) * grown * (0.92 + 0.06 * hairs)
    opacity: Tensor = torch.maximum(stubble, beard).clamp(0, 1)
    return opacity


def _find_parts(
    style: BeardStyleParameters, side: Tensor, height: Tensor
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Shares of cheeks and jaw, of the chin, of the moustache and of the bridge between them."""
    line = -0.62 + expand_scalar(style.cheek_line) + 0.48 * (side - 0.3).clamp_min(0)
    under = soft_step(height + 1.2, 0.08)
    ears = soft_step(1.44 - side, 0.06) * soft_step(0.12 - height, 0.1)
    cheeks = soft_step(line - height, 0.09) * ears * under * soft_step(side - 0.2, 0.1)
    chin = soft_step(0.3 - side, 0.09) * soft_step(-0.755 - height, 0.05) * under
    lip = soft_step(-0.485 - 0.25 * side - height, 0.035) * soft_step(
        height + 0.63 + 0.4 * side, 0.04
    )
    moustache = lip * soft_step(0.29 - side, 0.05)
    ring = soft_step(side - 0.2, 0.05) * soft_step(0.33 - side, 0.06)
    bridge = ring * soft_step(-0.55 - height, 0.05) * soft_step(height + 1.0, 0.1)
    return cheeks, chin, moustache, bridge


def _find_cheeks(azimuth: Tensor, elevation: Tensor) -> Tensor:
    rising = elevation - 0.25 * (azimuth.abs() - 0.5)
    return evaluate_gaussian(azimuth, rising, 0.55, -0.27, 0.2, 0.1)


def _find_lids(azimuth: Tensor, elevation: Tensor) -> Tensor:
    rising = elevation - 0.1 * (azimuth.abs() - 0.34)
    return evaluate_gaussian(azimuth, rising, 0.35, 0.095, 0.13, 0.042)


def _find_lips(side: Tensor, elevation: Tensor) -> Tensor:
    """Lips with a sharp edge, and a dip in the middle of the upper one."""
    round_ = (1 - (side / 0.205) ** 2).clamp_min(0)
    dip = 0.014 * torch.exp(-((side / 0.035) ** 2))
    top, bottom = -0.655 + 0.062 * round_**0.75 - dip, -0.655 - 0.086 * round_**0.8
    inside = torch.minimum(top - elevation, elevation - bottom)
    return soft_step(inside, 0.014) * soft_step(0.205 - side, 0.01)


def _line_eyes(side: Tensor, elevation: Tensor) -> Tensor:
    """A line along both lids, drawn out a little at the outer corner."""
    across = side - 0.34
    upper = torch.exp(-(((elevation - 0.058 + 1.5 * across**2 - 0.1 * across) / 0.012) ** 2))
    lower = torch.exp(-(((elevation + 0.018 - 0.9 * across**2) / 0.01) ** 2))
    length = soft_step(0.17 - across.abs(), 0.03)
    return torch.maximum(upper, 0.6 * lower) * length


def _paint(make_up: CosmeticParameters, azimuth: Tensor, elevation: Tensor) -> Layer:
    worn = make_up.paint.nonzero()[:, 0]
    face = soft_step(1.2 - azimuth.abs(), 0.1) * soft_step(elevation + 1.05, 0.05)
    place = face * soft_step(_resize(make_up.paint_noise[worn]), 0.12)
    return _spread(make_up.paint, make_up.paint_colour, place)


def _stick_plaster(make_up: CosmeticParameters, azimuth: Tensor, elevation: Tensor) -> Layer:
    """A strip with round ends."""
    worn = make_up.plaster_opacity.nonzero()[:, 0]
    centre, height, angle, length, width = (
        expand_scalar(one) for one in make_up.plaster[worn].unbind(1)
    )
    x, y = azimuth - centre, elevation - height
    along = (x * angle.cos() + y * angle.sin()).abs() - (length - width)
    across = y * angle.cos() - x * angle.sin()
    distance = torch.hypot(along.clamp_min(0), across)
    place = soft_step(width - distance, 0.012)
    return _spread(make_up.plaster_opacity, make_up.plaster_colour, place)


def _resize(noise: Tensor) -> Tensor:
    return F.interpolate(noise, CHART_SIZE, mode="bilinear")
