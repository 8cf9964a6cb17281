"""Skin, hair and features of a synthetic head, painted on its chart."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from kornia.filters import gaussian_blur2d
from torch import Tensor

from skinnet.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.shape.procedural import chart, relief
from train.brush import column, soft_step

REGIONS = ((0.0, 0.50, 0.50, 0.20), (0.52, -0.28, 0.20, 0.15), (0.0, -0.30, 0.14, 0.14),
           (0.34, 0.05, 0.16, 0.10), (0.0, -0.66, 0.17, 0.055), (0.0, -1.0, 0.3, 0.15))  # fmt: skip
"""Azimuth, elevation and widths of forehead, cheeks, nose, lids, lips and chin."""


class Textures(NamedTuple):
    """Charts [batch, channels, rows, columns]: pigments, colour of what is not skin, masks."""

    melanin: Tensor
    hemoglobin: Tensor
    paint: Tensor
    cover: Tensor
    oil: Tensor
    shade: Tensor


def paint_head(scene: dict[str, Tensor], rows: int, columns: int) -> tuple[Textures, Tensor]:
    """Textures of a batch of scenes, and the radius of the head with its hair.

    `cover` is the share of a texel that is not skin, `shade` the light that its hollow lets in.
    """
    azimuth, elevation = chart(rows, columns)
    azimuth, elevation = (axis.to(scene["f_mel"].device) for axis in (azimuth, elevation))
    melanin, hemoglobin = _pigments(scene, azimuth, elevation)
    oil = (
        0.4
        + _region(azimuth, elevation, *REGIONS[2])
        + 0.6 * _region(azimuth, elevation, *REGIONS[0])
    )
    paint = torch.zeros(len(melanin), 3, rows, columns, device=melanin.device)
    cover = torch.zeros(len(melanin), 1, rows, columns, device=melanin.device)
    hair = _hair(scene, azimuth.abs(), elevation)
    for colour, mask in _layers(scene, hair, azimuth, elevation):
        paint = paint * (1 - mask) + colour * mask
        cover = cover + mask - cover * mask
    bald = relief(scene["identity"], rows, columns)
    radius = bald + column(scene["volume"]) * hair
    paint = paint / cover.clamp_min(1e-3)
    hollow = (gaussian_blur2d(bald, 21, (6.0, 6.0)) - bald).clamp_min(0)
    shade = torch.exp(-column(scene["occlusion"]) * hollow)
    oil = oil.expand_as(cover)
    return Textures(melanin, hemoglobin, paint, cover, oil, shade), radius


def _pigments(
    scene: dict[str, Tensor], azimuth: Tensor, elevation: Tensor
) -> tuple[Tensor, Tensor]:
    shape = (elevation.shape[0], azimuth.shape[1])
    regions = torch.stack([_region(azimuth, elevation, *place) for place in REGIONS])
    freckles = F.interpolate(scene["freckles"], shape, mode="bilinear")
    logs = []
    for name in ("melanin", "blood"):
        log = torch.einsum("br,rhw->bhw", scene[f"{name}_regions"], regions)[:, None]
        for octave in ("coarse", "fine"):
            noise = F.interpolate(scene[f"{name}_{octave}"], shape, mode="bilinear")
            log = log + noise
        logs.append(log)
    melanin = column(scene["f_mel"]) * (logs[0] + 0.4 * freckles).exp()
    hemoglobin = column(scene["f_blood"]) * logs[1].exp()
    return melanin.clamp(1e-4, F_MEL_MAX), hemoglobin.clamp(1e-4, F_BLOOD_MAX)


def _layers(
    scene: dict[str, Tensor], hair: Tensor, azimuth: Tensor, elevation: Tensor
) -> list[tuple[Tensor, Tensor]]:
    side = azimuth.abs()
    colour = scene["hair"][:, :, None, None]
    shape = (elevation.shape[0], azimuth.shape[1])
    strands = F.interpolate(scene["strands"], shape, mode="bilinear").exp()
    layers = [
        (colour * strands, mask)
        for mask in (
            hair,
            _beard(scene, side, elevation),
            _brow(scene, side, elevation),
        )
    ]
    layers += _eye(scene, side, elevation) + _mouth(scene, azimuth, elevation)
    return layers + _glasses(scene, side, elevation)


def _hair(scene: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    line = column(scene["hairline"]) - 0.25 * side**2
    temples = soft_step(side - column(scene["sides"]), 0.05) * soft_step(elevation + 0.25, 0.08)
    ears = 1 - soft_step(0.22 - ((side - 1.5) ** 2 / 0.5 + (elevation + 0.1) ** 2).sqrt(), 0.03)
    top = soft_step(elevation - line, 0.04)
    return top + temples * ears * (1 - top)


def _beard(scene: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    jaw = soft_step(-0.42 - elevation - 0.35 * (1 - (side / 0.6).clamp(0, 1)) * (side > 0.25), 0.06)
    lips = _region(side, elevation, 0.0, -0.66, 0.16, 0.06)
    return column(scene["beard"]) * jaw * (1 - lips).clamp(0, 1) * soft_step(1.4 - side, 0.1)


def _brow(scene: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    arch = elevation - (0.19 + 0.05 * (side - 0.1) - 0.35 * (side - 0.35).clamp_min(0) ** 2)
    length = soft_step(side - 0.12, 0.03) * soft_step(0.58 - side, 0.04)
    return column(scene["brow"]) * length * torch.exp(-((arch / 0.032) ** 2))


def _eye(scene: dict[str, Tensor], side: Tensor, elevation: Tensor) -> list[tuple[Tensor, Tensor]]:
    across, up = side - 0.34, elevation - 0.02
    height = column(scene["eye"])
    opening = soft_step(1 - ((across / 0.135) ** 2 + (up / height) ** 2), 0.25)
    distance = (across**2 + up**2).sqrt()
    lashes = torch.exp(-((((across / 0.14) ** 2 + (up / (height * 1.1)) ** 2 - 1.05) / 0.25) ** 2))
    white = torch.full((1, 3, 1, 1), 0.55, device=side.device)
    dark = torch.full((1, 3, 1, 1), 0.015, device=side.device)
    iris = scene["iris"][:, :, None, None]
    return [
        (dark, 0.6 * lashes * (up > -0.01)),
        (white, opening),
        (iris, opening * soft_step(0.055 - distance, 0.012)),
        (dark, opening * soft_step(0.022 - distance, 0.008)),
    ]


def _mouth(
    scene: dict[str, Tensor], azimuth: Tensor, elevation: Tensor
) -> list[tuple[Tensor, Tensor]]:
    open = column(scene["smile"]) + 1e-3
    up = elevation + 0.66 - 0.25 * azimuth**2 * (open > 0.01)
    inside = soft_step(1 - ((azimuth / 0.19) ** 2 + (up / open) ** 2), 0.3) * (open > 0.01)
    gap = torch.exp(-((up / 0.012) ** 2)) * soft_step(0.21 - azimuth.abs(), 0.04)
    nostrils = _region(azimuth.abs(), elevation, 0.075, -0.435, 0.03, 0.016)
    teeth = torch.tensor([0.55, 0.50, 0.42], device=azimuth.device)[None, :, None, None]
    dark = torch.tensor([0.05, 0.012, 0.01], device=azimuth.device)[None, :, None, None]
    return [(dark, 0.7 * gap), (dark, 0.85 * nostrils), (teeth, inside)]


def _glasses(
    scene: dict[str, Tensor], side: Tensor, elevation: Tensor
) -> list[tuple[Tensor, Tensor]]:
    ring = (((side - 0.34) / 0.26) ** 2 + ((elevation - 0.0) / 0.19) ** 2).sqrt() - 1
    bar = torch.exp(-(((elevation - 0.05) / 0.02) ** 2)) * ((side < 0.1) | (side > 0.58))
    frame = torch.maximum(torch.exp(-((ring / 0.09) ** 2)), bar)
    dark = torch.full((1, 3, 1, 1), 0.03, device=side.device)
    return [(dark, column(scene["glasses"]) * frame)]


def _region(
    azimuth: Tensor, elevation: Tensor, at: float, height: float, wide: float, tall: float
) -> Tensor:
    across = (azimuth.abs() - at if at else azimuth) / wide
    return torch.exp(-(across**2 + ((elevation - height) / tall) ** 2) / 2)
