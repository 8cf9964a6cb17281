"""What stands behind a synthetic head: wall, clothes, hair that falls, and the neck."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import Tensor

from skinnet.shape.procedural import unit
from train.brush import column, soft_step


class Body(NamedTuple):
    """Layers behind the head [batch, channels, height, width].

    `paint` is the colour of what is not skin, `lit` where it takes the scene's shading (a wall has
    its own), `neck` the share of each pixel that is the skin of the neck, `normal` its normals and
    those of the clothes, `shade` the shadow under the chin.
    """

    paint: Tensor
    lit: Tensor
    neck: Tensor
    normal: Tensor
    shade: Tensor


def draw_body(scene: dict[str, Tensor], x: Tensor, y: Tensor) -> Body:
    """The layers at positions in half heads, x to the right and y up, [batch, 1, height, width]."""
    paint = _wall(scene, x)
    lit = torch.zeros_like(x)
    for colour, mask in (_clothes(scene, x, y), _falling_hair(scene, x, y)):
        paint = paint * (1 - mask) + colour * mask
        lit = lit + mask - lit * mask
    width = column(scene["neck"])
    neck = (
        soft_step(width - x.abs(), 0.02)
        * soft_step(-0.5 - y, 0.02)
        * (1 - _clothes(scene, x, y)[1])
    )
    across = (x / width).clamp(-1, 1)
    normal = torch.cat([across, 0.2 * torch.ones_like(x), (1 - across**2).sqrt() + 0.1], 1)
    shade = 1 - 0.5 * torch.exp(-((-0.75 - y).clamp_min(0) / 0.3))
    return Body(paint, lit, neck, unit(normal), shade)


def _wall(scene: dict[str, Tensor], x: Tensor) -> Tensor:
    size = x.shape[-2:]
    wall = F.interpolate(scene["wall"], size, mode="bicubic", align_corners=True)
    clutter = F.interpolate(scene["clutter"], size, mode="bilinear").exp()
    return (wall * clutter * column(scene["wall_light"])).clamp(0.001, 1.5)


def _clothes(scene: dict[str, Tensor], x: Tensor, y: Tensor) -> tuple[Tensor, Tensor]:
    collar, slope, opening = (column(value) for value in scene["shoulders"].unbind(1))
    out = (x.abs() - column(scene["neck"])).clamp_min(0)
    inward = (1 - x.abs() / column(scene["neck"])).clamp_min(0)
    top = -(0.45 + 0.7 * collar) - 0.4 * slope * out - 0.25 * opening * inward
    cloth = F.interpolate(scene["cloth"], x.shape[-2:], mode="bilinear")
    pattern = F.interpolate(scene["pattern"], x.shape[-2:], mode="nearest").exp()
    return (cloth * pattern).clamp(0.003, 1.0), soft_step(top - y, 0.02)


def _falling_hair(scene: dict[str, Tensor], x: Tensor, y: Tensor) -> tuple[Tensor, Tensor]:
    length, volume = column(scene["length"]), column(scene["volume"])
    wide = 0.80 + volume + 0.1 * (-y).clamp(0, 1)
    mask = soft_step(wide - x.abs(), 0.03) * soft_step(y + length, 0.05) * soft_step(0.7 - y, 0.05)
    strands = F.interpolate(scene["strands"], x.shape[-2:], mode="bilinear").exp()
    return scene["hair"][:, :, None, None] * strands, mask * (length > 0)
