"""Colours of headwear, face masks, scarves, long beards and dark lenses."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float, Int
from torch import Tensor

from train.synthetic.labels import BEARD, FACE_MASK, HEADWEAR, LENS, SCARF
from train.synthetic.scene import FaceParameters, GarmentParameters

_WOVEN = 0.06
"""Standard deviation of the log brightness of threads."""

_LENS_REFLECTANCE = 0.02
"""Of a coated lens, from both of its sides."""

_SCALE = (torch.pi, 1.6)
"""Extent of the noise of a pattern on the chart."""

_Colours = Float[Tensor, "pixels 3"]
_Values = Float[Tensor, "pixels"]


class _Pixels(NamedTuple):
    """Number in the batch, row and column of pixels, and their places on the chart."""

    picture: Int[Tensor, "pixels"]
    row: Int[Tensor, "pixels"]
    column: Int[Tensor, "pixels"]
    x: _Values
    y: _Values


def colour_garments(
    colour: Float[Tensor, "batch 3 height width"],
    face: FaceParameters,
    label: Float[Tensor, "batch 1 height width"],
    place: Float[Tensor, "batch 2 height width"],
    own_skin: Float[Tensor, "batch 3 1 1"],
) -> None:
    """Colour what only the variety `any` has, in place.

    Args:
        colour: Linear sRGB under white light, which is changed where there are garments.
        face: A batch.
        label: Labels of `train.synthetic.labels`.
        place: Places on the labels' charts.
        own_skin: Linear sRGB of the wearer's skin, which some garments share.
    """
    garments = face.garments
    for number, kind in enumerate((HEADWEAR, FACE_MASK, SCARF)):
        pixels = _find_pixels(label, place, kind)
        own = own_skin[pixels.picture, :, 0, 0]
        _fill(colour, pixels, _colour_cloth(garments, number, pixels, own))
    lenses, beards = (_find_pixels(label, place, kind) for kind in (LENS, BEARD))
    _fill(colour, lenses, _colour_lens(garments, lenses))
    _fill(colour, beards, _colour_beard(face, beards))


def _find_pixels(label: Tensor, place: Tensor, kind: int) -> _Pixels:
    picture, row, column = (label[:, 0] == kind).nonzero(as_tuple=True)
    return _Pixels(picture, row, column, *place[picture, :, row, column].unbind(1))


def _fill(colour: Tensor, pixels: _Pixels, values: _Colours) -> None:
    colour[pixels.picture, :, pixels.row, pixels.column] = values


def _colour_cloth(
    garments: GarmentParameters, number: int, pixels: _Pixels, own_skin: _Colours
) -> _Colours:
    first, second = garments.colours[pixels.picture, number].unbind(1)
    own = garments.own_skin[pixels.picture, number, None]
    noise = _sample_noise(garments.noise[:, number], pixels, _SCALE)
    share = _mix_pattern(garments, number, pixels, noise)[:, None] * (1 - own)
    ground = first * (1 - own) + own_skin * own
    cloth: _Colours = (ground * (1 - share) + second * share) * (_WOVEN * noise[:, None]).exp()
    return cloth


def _mix_pattern(
    garments: GarmentParameters, number: int, pixels: _Pixels, noise: _Values
) -> _Values:
    """Stripes of two directions and spots, by their weights."""
    stripes, lines, spots = garments.amounts[pixels.picture, number].unbind(1)
    share = spots * torch.sigmoid(7 * (noise - 0.3))
    waves = garments.waves[pixels.picture, number].unbind(1)
    for weight, wave in zip((stripes, lines), waves, strict=True):
        right, up, phase = wave.unbind(1)
        value = torch.sin(right * pixels.x + up * pixels.y + phase)
        share = share + weight * torch.sigmoid(7 * value)
    return share


def _sample_noise(
    noise: Float[Tensor, "batch rows columns"], pixels: _Pixels, scale: tuple[float, float]
) -> _Values:
    """Interpolate noise that is repeated beyond the scale."""
    rows, columns = noise.shape[1:]
    y, x = (pixels.y / scale[1] + 1) / 2 * rows, (pixels.x / scale[0] + 1) / 2 * columns
    value = torch.zeros_like(x)
    for i in (0, 1):
        for k in (0, 1):
            row, column = y.floor() + i, x.floor() + k
            weight = (1 - (y - row).abs()) * (1 - (x - column).abs())
            index = row.long() % rows, column.long() % columns
            value = value + weight * noise[pixels.picture, index[0], index[1]]
    return value


def _colour_lens(garments: GarmentParameters, pixels: _Pixels) -> _Colours:
    """Dark glass, or a mirror of a bright sky over dark ground."""
    horizon = torch.sigmoid(8 * (pixels.y - 0.15 * torch.sin(5 * pixels.x) + 0.1))[:, None]
    mirror, tint = garments.mirror[pixels.picture, None], garments.lens[pixels.picture]
    bright = tint / tint.amax(1, keepdim=True).clamp_min(1e-3)
    lens: _Colours = tint * (1 - mirror) + mirror * bright * (0.06 + 0.6 * horizon)
    return lens


def _colour_beard(face: FaceParameters, pixels: _Pixels) -> _Colours:
    hairs = _sample_noise(face.beard_style.hairs[:, 0], pixels, (2.0, 1.5))
    return face.beard_style.colour[pixels.picture] * (0.4 * hairs[:, None]).exp()


def reflect_in_lenses(
    garments: GarmentParameters,
    first: Int[Tensor, "batch"],
    sky: Float[Tensor, "batch 9"],
    film: Float[Tensor, "batch 1 height width"],
) -> Float[Tensor, "batch 1 height width"]:
    """Reflect the sky, and windows as blots, in clear lenses.

    Args:
        garments: Of all paintings.
        first: The first painting of each picture.
        sky: As in `LightParameters`.
        film: 1 where there is a clear lens, otherwise 0.

    Returns:
        Light relative to a white diffuser that faces the light.
    """
    noise = garments.noise[first, :1]
    blots = F.interpolate(noise, film.shape[-2:], mode="bicubic", align_corners=True)
    windows = torch.sigmoid(6 * (blots - 0.9)) * garments.reflection[first, None, None, None]
    return film * sky[:, :1, None, None].clamp_min(0) * (_LENS_REFLECTANCE + windows)
