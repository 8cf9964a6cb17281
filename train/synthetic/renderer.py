"""A lot and the geometry under it to a photograph and the truth behind it."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float
from kornia.color import rgb_to_grayscale
from torch import Tensor

from skinnet.network.autoencoder import SHADING_MAX, SkinMaps
from skinnet.physics import Capture, SkinDecoder
from skinnet.shape.procedural_head import CHART_EXTENT
from train.batch import Batch
from train.synthetic.face_painting import Paint, enlarged, paint_skin
from train.synthetic.labels import CLOTH, EYE, GLASSES, HAIR, MOUTH, SKIN, TEETH
from train.synthetic.shading import Shade, shade
from train.synthetic.simulated_camera import photographed, pictured
from train.synthetic.tensors import column, soft_step

METERED = 0.25
"""Mean luminance of skin that a camera which meters for it would choose."""

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch 1 height width"]


class Ground(NamedTuple):
    """Geometry buffers of a batch, channels first."""

    label: Map
    normal: Image
    chart: Float[Tensor, "batch 2 height width"]
    openness: Map


class Skin(NamedTuple):
    """Skin in a batch of pictures: pigments, colour, its share of each pixel, and its light."""

    melanin: Float[Tensor, "batch height width"]
    hemoglobin: Float[Tensor, "batch height width"]
    albedo: Image
    share: Map
    lit: Shade


@torch.no_grad()
def render(lot: dict[str, Tensor], decoder: SkinDecoder, split: str = "train") -> Batch:
    """Photographs of a batch of lots, each with the buffers of a head, and their truth.

    On skin the picture is shading * skin + specular under the measured camera; elsewhere the truth
    is no shading and an offset that is the light itself, before lens and tone curve.
    """
    ground = _ground(lot)
    over = _sampled(paint_skin(lot), ground.chart)
    skin = (ground.label == SKIN).float()
    share = skin * (1 - over.cover)
    normal = _normalise(ground.normal + skin * F.pad(over.bump, (0, 0, 0, 0, 0, 1)))
    oil = torch.where(skin > 0, over.oil, _GLOSS.to(skin)[ground.label.long()])
    lit = shade(lot, normal, ground.openness, lot["seen"], oil)
    matrix, capture = pictured(lot, decoder.camera, split)
    white = matrix.sum(-2)[:, :, None, None]
    melanin, hemoglobin = over.melanin[:, 0], over.hemoglobin[:, 0]
    other = _other(lot, ground, over) * torch.where(ground.label > 0, lit.diffuse, 1.0)
    other = (other + lit.specular * (ground.label > 0)) * white
    albedo = decoder.albedo(melanin, hemoglobin, matrix)
    face = Skin(melanin, hemoglobin, albedo, share, lit)
    return developed(lot, face, (1 - share) * other, white, capture)


def developed(
    lot: dict[str, Tensor], skin: Skin, rest: Image, white: Image, capture: Capture
) -> Batch:
    """Photographs of skin and of the linear light `rest` beside it, and their truth."""
    diffuse, specular = skin.lit
    linear = skin.share * (skin.albedo * diffuse + specular * white) + rest
    gain = _exposed(lot, linear, skin.share)
    truth = SkinMaps(
        skin.melanin,
        skin.hemoglobin,
        (gain * skin.share * diffuse)[:, 0].clamp_max(SHADING_MAX),
        (gain * skin.share * specular)[:, 0].clamp_max(1),
        (gain * rest).clamp(-1, 1),
        skin.share[:, 0],
    )
    batch = Batch(photographed(lot, gain * linear), truth.mask, truth, capture, skin.albedo)
    return _flipped(batch, lot["flip"] > 0)


_GLOSS = torch.zeros(8)
_GLOSS[EYE], _GLOSS[TEETH], _GLOSS[MOUTH], _GLOSS[GLASSES], _GLOSS[HAIR] = 1.5, 1.0, 0.5, 1.5, 0.3


def _ground(lot: dict[str, Tensor]) -> Ground:
    label, chart = lot["label"][:, None].float(), lot["chart"].movedim(-1, 1).float()
    return Ground(label, normals(lot), chart, openness(lot))


def normals(lot: dict[str, Tensor]) -> Image:
    """Unit normals of the geometry buffers, ahead where there is none."""
    return _normalise(lot["normal"].movedim(-1, 1).float() + 1e-3)


def openness(lot: dict[str, Tensor]) -> Map:
    """The share of the sky of the geometry buffers."""
    return lot["openness"][:, None].float() / 255


def _sampled(paint: Paint, place: Float[Tensor, "batch 2 height width"]) -> Paint:
    """The charts' values at places in azimuth and elevation."""
    grid = torch.stack([place[:, 0] / CHART_EXTENT[0], -place[:, 1] / CHART_EXTENT[1]], -1)
    over = F.grid_sample(torch.cat(paint, 1), grid, align_corners=True, padding_mode="border")
    return Paint(*over.split([one.shape[1] for one in paint], 1))


def _other(lot: dict[str, Tensor], ground: Ground, over: Paint) -> Image:
    """Colour of all that is not skin; on skin, of what covers it."""
    colour = torch.where(ground.label == SKIN, over.paint, _wall(lot, ground.label.shape[-2:]))
    parts = {
        EYE: _eye(lot, ground.chart),
        TEETH: lot["teeth"][:, :, None, None],
        MOUTH: ground.chart.new_tensor([0.14, 0.03, 0.03])[None, :, None, None],
        HAIR: _hair(lot, ground.chart),
        GLASSES: lot["frame"][:, :, None, None],
        CLOTH: _cloth(lot, ground.chart),
    }
    for label, value in parts.items():
        colour = torch.where(ground.label == label, value, colour)
    return colour


def _wall(lot: dict[str, Tensor], size: torch.Size) -> Image:
    wall = F.interpolate(lot["wall"], size, mode="bicubic", align_corners=True)
    parts = (F.interpolate(lot[name], size, mode="bilinear") for name in ("clutter", "litter"))
    return (wall * sum(parts).exp() * column(lot["wall_light"])).clamp(0.001, 1.5)


def _eye(lot: dict[str, Tensor], place: Float[Tensor, "batch 2 height width"]) -> Image:
    """Sclera, iris with a dark rim, and pupil, by the distance from the gaze's axis."""
    radius = place.norm(dim=1, keepdim=True)
    inside, pupil = soft_step(1 - radius, 0.12), soft_step(0.38 - radius, 0.12)
    iris = lot["iris"][:, :, None, None] * (0.35 + 0.65 * soft_step(0.85 - radius, 0.2))
    colour = lot["sclera"][:, :, None, None] * (1 - inside) + iris * inside
    eye: Image = colour * (1 - pupil) + 0.008 * pupil
    return eye


def _hair(lot: dict[str, Tensor], place: Float[Tensor, "batch 2 height width"]) -> Image:
    grid = torch.stack([place[:, 0] / torch.pi, -place[:, 1] / 2], -1)
    strands = F.grid_sample(
        enlarged(lot["strands"]), grid, align_corners=True, padding_mode="reflection"
    )
    return lot["hair"][:, :, None, None] * strands.exp()


def _cloth(lot: dict[str, Tensor], place: Float[Tensor, "batch 2 height width"]) -> Image:
    """A jacket over a shirt, with or without a tie, in its own pattern."""
    x, y = place.unbind(1)
    grid = torch.stack([x / 2, y / 2], -1)
    pattern = F.grid_sample(lot["pattern"], grid, align_corners=True, padding_mode="reflection")
    opening = soft_step(0.30 + 0.35 * (y + 1.2) - x.abs(), 0.03)[:, None]
    tie = soft_step(0.07 - 0.05 * (y + 1.2) - x.abs(), 0.02)[:, None] * column(lot["tie"])
    colour = lot["cloth"][:, :, None, None] * (1 - opening)
    colour = colour + lot["shirt"][:, :, None, None] * opening
    colour = colour * (1 - tie) + lot["tie_colour"][:, :, None, None] * tie
    cloth: Image = (colour * pattern.exp()).clamp(0.003, 1)
    return cloth


def _exposed(lot: dict[str, Tensor], linear: Image, share: Map) -> Float[Tensor, "batch 1 1 1"]:
    light = rgb_to_grayscale(linear)
    mean = (light * share).sum((1, 2, 3)) / share.sum((1, 2, 3)).clamp_min(1)
    wanted = (METERED / mean.clamp(0.01, 1)) ** lot["metering"]
    return column((lot["exposure"] * wanted).clamp(0.15, 5))


def _flipped(batch: Batch, flip: Tensor) -> Batch:
    assert batch.truth is not None and batch.albedo is not None

    def turned(value: Tensor) -> Tensor:
        where = flip.reshape(-1, *[1] * (value.ndim - 1))
        return torch.where(where, value.flip(-1), value)

    truth = SkinMaps(*map(turned, batch.truth))
    return Batch(turned(batch.photograph), truth.mask, truth, batch.capture, turned(batch.albedo))


def _normalise(vectors: Float[Tensor, "batch 3 *shape"]) -> Float[Tensor, "batch 3 *shape"]:
    """Divide vectors along axis 1 by their length; many times faster on a CPU than F.normalize."""
    return vectors * (vectors**2).sum(1, keepdim=True).rsqrt()
