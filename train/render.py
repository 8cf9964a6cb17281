"""Synthetic portraits: a scene drawn by lot to a photograph and the truth behind it."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from kornia.filters import gaussian_blur2d
from torch import Tensor

from skinnet.autoencoder import SHADING_MAX, SkinMaps
from skinnet.capture import Capture
from skinnet.decoder import SkinDecoder, srgb
from skinnet.shape.procedural import Surface, sample, surface, unit
from train.batch import Batch
from train.body import Body, draw_body
from train.brush import column
from train.texture import Textures, paint_head

CHART_SIZE = (112, 136)
_STEPS = 5


@torch.no_grad()
def render(scene: dict[str, Tensor], decoder: SkinDecoder) -> Batch:
    """Photographs of a batch of scenes, as wide and as high as their grain, with their truth.

    On skin the picture is `SkinDecoder`'s; elsewhere the truth is no shading and an offset that is
    the picture itself. A pixel that is partly skin is weighted by its share.
    """
    textures, radius = paint_head(scene, *CHART_SIZE)
    head = surface(radius)
    view = _trace(scene, head)
    x, y = view.position.unbind(1)
    body = draw_body(scene, x[:, None], y[:, None])
    melanin, hemoglobin, paint, share, normal, oil, shade = _merge(
        scene, view, body, head, textures
    )
    shading, specular = shaded(scene, normal, oil, shade)
    other = paint * torch.where(view.inside > 0.5, shading, 1 - body.lit + body.lit * shading)
    other = (other + 0.5 * specular * view.inside) * column(scene["exposure"]).sqrt()
    truth = SkinMaps(
        melanin[:, 0],
        hemoglobin[:, 0],
        (share * shading)[:, 0].clamp_max(SHADING_MAX),
        (share * specular)[:, 0].clamp_max(1),
        ((1 - share) * other).clamp_max(1),
        share[:, 0],
    )
    capture = Capture(*(scene[name] for name in Capture._fields))
    linear = decoder.compose(*truth[:5], capture)
    return Batch(photographed(scene, linear), truth.mask, truth, capture)


class _View(NamedTuple):
    position: Tensor
    direction: Tensor
    inside: Tensor


def _trace(scene: dict[str, Tensor], head: Surface) -> _View:
    """Where each pixel's ray meets the head, seen from afar.

    The distance from the middle of the head does not depend on its pose, so the depth is
    z = sqrt(r(direction)^2 - x^2 - y^2), a fixed point.
    """
    size = scene["grain"].shape[-1]
    ramp = (torch.arange(size, device=scene["grain"].device) * 2 + 1) / size - 1
    y, x = torch.meshgrid(-ramp, ramp, indexing="ij")
    position = torch.stack([x, y]) - scene["centre"][:, :, None, None]
    position = position / column(scene["zoom"])
    squared = (position**2).sum(1, keepdim=True)
    radius = torch.ones_like(squared)
    turn = _rotation(scene)
    for _ in range(_STEPS):
        depth = (radius**2 - squared).clamp_min(0).sqrt()
        point = torch.einsum("bji,bjhw->bihw", turn, torch.cat([position, depth], 1))
        direction = point / (squared + depth**2).sqrt()
        radius = sample(head.radius, direction)
    pixels = (radius - squared.sqrt()) * column(scene["zoom"]) * size / 2
    return _View(position, direction, (pixels + 0.5).clamp(0, 1))


def _rotation(scene: dict[str, Tensor]) -> Tensor:
    pitch, yaw, roll = scene["angles"].unbind(1)
    zero, one = torch.zeros_like(yaw), torch.ones_like(yaw)
    about_x = [one, zero, zero, zero, pitch.cos(), -pitch.sin(), zero, pitch.sin(), pitch.cos()]
    about_y = [yaw.cos(), zero, yaw.sin(), zero, one, zero, -yaw.sin(), zero, yaw.cos()]
    about_z = [roll.cos(), -roll.sin(), zero, roll.sin(), roll.cos(), zero, zero, zero, one]
    x, y, z = (torch.stack(terms, 1).unflatten(1, (3, 3)) for terms in (about_x, about_y, about_z))
    return z @ y @ x


def _merge(
    scene: dict[str, Tensor], view: _View, body: Body, head: Surface, textures: Textures
) -> tuple[Tensor, ...]:
    over = sample(torch.cat([*textures, head.normal], 1), view.direction)
    melanin, hemoglobin, paint, cover, oil, shade, normal = over.split([1, 1, 3, 1, 1, 1, 3], 1)
    normal = torch.einsum("bij,bjhw->bihw", _rotation(scene), normal)
    normal = unit(normal)
    inside = view.inside
    hit = inside > 0.5
    share = (inside * (1 - cover) + (1 - inside) * body.neck).clamp(0, 1)
    paint = inside * cover * paint + (1 - inside) * (1 - body.neck) * body.paint
    return (
        torch.where(hit, melanin, column(scene["f_mel"])),
        torch.where(hit, hemoglobin, column(scene["f_blood"])),
        paint / (1 - share).clamp_min(1e-3),
        share,
        torch.where(hit, normal, body.normal),
        torch.where(hit, oil, torch.full_like(oil, 0.3)),
        torch.where(hit, shade, body.shade),
    )


def shaded(
    scene: dict[str, Tensor], normal: Tensor, oil: Tensor, shade: Tensor
) -> tuple[Tensor, Tensor]:
    """Diffuse shading under a first-order sky and three lamps, and Blinn-Phong highlights."""
    sky = scene["sky"]
    ambient = column(sky[:, 0]) + torch.einsum("bi,bihw->bhw", sky[:, 1:], normal)[:, None]
    half = F.normalize(scene["lamps"] + sky.new_tensor([0, 0, 1]), dim=2)
    facing = torch.einsum("bli,bihw->blhw", scene["lamps"], normal).clamp_min(0)
    glint = torch.einsum("bli,bihw->blhw", half, normal).clamp_min(0)
    strength = scene["strength"][:, :, None, None]
    sharpness = column(scene["sharpness"])
    diffuse = (ambient.clamp_min(0.05) + (strength * facing).sum(1, keepdim=True)) * shade
    lobe = (strength * glint**sharpness * (facing > 0)).sum(1, keepdim=True)
    specular = column(scene["oil"]) * oil * lobe * (1 + sharpness / 8)
    exposure = column(scene["exposure"])
    return diffuse * exposure, (specular * exposure).clamp_max(1)


def photographed(scene: dict[str, Tensor], linear: Tensor) -> Tensor:
    sigma = (scene["blur"] * linear.shape[-1] / 128 + 0.05)[:, None].expand(-1, 2)
    display = srgb(gaussian_blur2d(linear, 5, sigma)) + scene["grain"]
    return (display.clamp(0, 1) * 255).round() / 255
