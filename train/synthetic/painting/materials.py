"""Colours of all that is not skin: eyes, teeth, hair, glasses, clothes and the wall."""

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from train.synthetic.labels import (
    BEARD,
    CLOTH,
    EYE,
    GLASSES,
    HAIR,
    LENS,
    MATERIALS,
    MOUTH,
    NAIL,
    TEETH,
)
from train.synthetic.painting.face_painting import resize_to_chart
from train.synthetic.painting.garment_colours import colour_garments
from train.synthetic.painting.style_painting import has_style
from train.synthetic.scene import (
    FeatureParameters,
    HairParameters,
    SceneParameters,
    SurroundingsParameters,
)
from train.synthetic.tensors import expand_colour, expand_scalar, soft_step

OIL = torch.zeros(MATERIALS)
"""Oil of each label except skin: a factor on its specular reflection, 1 for oily skin."""
OIL[EYE], OIL[TEETH], OIL[MOUTH], OIL[GLASSES], OIL[HAIR] = 1.5, 1.0, 0.5, 1.5, 0.3
OIL[NAIL], OIL[LENS], OIL[BEARD] = 1.2, 3.0, 0.3

_Image = Float[Tensor, "batch 3 height width"]
_Label = Float[Tensor, "batch 1 height width"]
_Place = Float[Tensor, "batch 2 height width"]


def colour_materials(
    scene: SceneParameters,
    label: _Label,
    place: _Place,
    cover_colour: _Image,
    own_skin: Float[Tensor, "batch 3 1 1"],
) -> _Image:
    """Colour every pixel by its label.

    Args:
        scene: A batch of paintings; head and camera are not used.
        label: Labels of `train.synthetic.labels`.
        place: Places on the labels' charts.
        cover_colour: Linear sRGB of what covers the skin.
        own_skin: Linear sRGB of the wearer's skin under white light.

    Returns:
        Linear sRGB under white light; on skin, and on the wall, it is `cover_colour`.
    """
    features = scene.face.features
    colour = cover_colour
    materials = {
        EYE: _colour_eye(features, place),
        TEETH: expand_colour(features.teeth),
        MOUTH: place.new_tensor([0.14, 0.03, 0.03])[None, :, None, None],
        HAIR: _colour_hair(scene.face.hair, place),
        GLASSES: expand_colour(features.glasses),
        CLOTH: _colour_clothes(scene.surroundings, place),
        NAIL: _colour_nails(features),
    }
    for number, value in materials.items():
        colour = torch.where(label == number, value, colour)
    if has_style(scene.face):
        colour_garments(colour, scene.face, label, place, own_skin)
    return colour


def colour_wall(surroundings: SurroundingsParameters, size: torch.Size) -> _Image:
    """Colour the wall of each picture, in linear sRGB under its own light."""
    wall = F.interpolate(surroundings.wall, size, mode="bicubic", align_corners=True)
    coarse, fine = (
        F.interpolate(one, size, mode="bilinear")
        for one in (surroundings.coarse_clutter, surroundings.fine_clutter)
    )
    light = expand_scalar(surroundings.wall_light)
    return (wall * (coarse + fine).exp() * light).clamp(0.001, 1.5)


def _colour_eye(features: FeatureParameters, place: _Place) -> _Image:
    """Sclera, iris with a dark rim, and pupil, by the distance from the gaze's axis."""
    radius = place.norm(dim=1, keepdim=True)
    inside, pupil = soft_step(1 - radius, 0.12), soft_step(0.38 - radius, 0.12)
    iris = expand_colour(features.iris) * (0.35 + 0.65 * soft_step(0.85 - radius, 0.2))
    colour = expand_colour(features.sclera) * (1 - inside) + iris * inside
    eye: _Image = colour * (1 - pupil) + 0.008 * pupil
    return eye


def _colour_nails(features: FeatureParameters) -> Float[Tensor, "batch 3 1 1"]:
    """Nails show their bed, or varnish if there is make-up."""
    bed = features.lipstick.new_tensor([0.50, 0.29, 0.24])
    varnished = features.make_up[:, None] > 0
    return expand_colour(torch.where(varnished, features.lipstick, bed))


def _colour_hair(hair: HairParameters, place: _Place) -> _Image:
    grid = torch.stack([place[:, 0] / torch.pi, -place[:, 1] / 2], -1)
    strands = F.grid_sample(
        resize_to_chart(hair.strands), grid, align_corners=True, padding_mode="reflection"
    )
    return expand_colour(hair.colour) * strands.exp()


def _colour_clothes(surroundings: SurroundingsParameters, place: _Place) -> _Image:
    """A jacket over a shirt, with or without a tie, all in one pattern."""
    x, y = place.unbind(1)
    pattern = F.grid_sample(
        surroundings.pattern,
        torch.stack([x / 2, y / 2], -1),
        align_corners=True,
        padding_mode="reflection",
    )
    opening = soft_step(0.30 + 0.35 * (y + 1.2) - x.abs(), 0.03)[:, None]
    tie = soft_step(0.07 - 0.05 * (y + 1.2) - x.abs(), 0.02)[:, None]
    tie = tie * expand_scalar(surroundings.tie)
    colour = expand_colour(surroundings.jacket) * (1 - opening)
    colour = colour + expand_colour(surroundings.shirt) * opening
    colour = colour * (1 - tie) + expand_colour(surroundings.tie_colour) * tie
    clothes: _Image = (colour * pattern.exp()).clamp(0.003, 1)
    return clothes
