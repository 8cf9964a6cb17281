"""Photographs as if by another photographer: changed framing, light, tone, grading and file."""

from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from torch import Tensor

from train.synthetic.photography.processing import grade, resample
from train.synthetic.photography.simulated_camera import apply_tone_curve, compress
from train.synthetic.sampling.wide_captures import (
    WARMING,
    make_no_processing,
    sample_processing,
)
from train.synthetic.scene import ProcessingParameters, map_tensors
from train.synthetic.tensors import expand_colour, make_tensors

_WARMTH_SD, _GREEN_SD, _EXPOSURE_SD = 16.0, 0.03, 0.25
_ANGLE_SD, _ZOOM_SD, _SHIFT_SD = 0.07, 0.08, 0.06
"""Spreads of the framing: in radians, of the logarithm, and in halves of the picture."""

_UNCHANGED_SHARE = 0.25
_TONE_SD = np.array([0.08, 0.1])

Image = Float[Tensor, "batch 3 height width"]


class Rephotography(NamedTuple):
    """How a photograph is changed.

    `framing` is the affine map from places in the new picture to those in the old one, both in
    [-1, 1], and `gain` a factor on linear sRGB.
    """

    framing: Float[Tensor, "*batch 2 3"]
    gain: Float[Tensor, "*batch 3"]
    tone: Float[Tensor, "*batch 2"]
    processing: ProcessingParameters
    quality: Float[Tensor, "*batch"]


def sample_rephotography(rng: np.random.Generator) -> Rephotography:
    """Sample a change, in float32; a quarter of all photographs change in their framing alone."""
    framing = torch.from_numpy(_sample_framing(rng)).float()
    if rng.random() < _UNCHANGED_SHARE:
        one, zero = torch.tensor(1.0), torch.tensor(0.0)
        return Rephotography(framing, one.expand(3), zero.expand(2), make_no_processing(), zero)
    log = rng.normal(0, _WARMTH_SD) * WARMING + rng.normal(0, _EXPOSURE_SD)
    log[1] -= rng.normal(0, _GREEN_SD)
    change = Rephotography(
        framing,
        **make_tensors(gain=np.exp(log), tone=rng.normal(0, _TONE_SD)),
        processing=sample_processing(rng, saturation=0.0),
        **make_tensors(quality=rng.choice([0, rng.uniform(20, 95)], p=(0.4, 0.6))),
    )
    return map_tensors(torch.Tensor.float, change)


def _sample_framing(rng: np.random.Generator) -> Float[np.ndarray, "2 3"]:
    """Turn, enlarge and move a little."""
    angle, zoom = rng.normal(0, _ANGLE_SD), np.exp(rng.normal(0, _ZOOM_SD))
    cosine, sine = zoom * np.cos(angle), zoom * np.sin(angle)
    right, down = rng.normal(0, _SHIFT_SD, 2)
    return np.array([[cosine, -sine, right], [sine, cosine, down]])


@torch.no_grad()
def reframe(
    change: Rephotography,
    layers: Float[Tensor, "batch channels height width"],
    nearest: bool = False,
) -> Float[Tensor, "batch channels height width"]:
    """Frame layers of photographs anew; the border continues outside.

    Args:
        change: How each photograph is changed.
        layers: Its photograph, mask or regions.
        nearest: Whether values are numbers of regions, which cannot be mixed.

    Returns:
        Layers of the same size.
    """
    grid = F.affine_grid(change.framing, list(layers.shape), align_corners=False)
    mode = "nearest" if nearest else "bilinear"
    return F.grid_sample(layers, grid, mode, padding_mode="border", align_corners=False)


@torch.no_grad()
def rephotograph(change: Rephotography, photograph: Image) -> Image:
    """Change photographs in all but their framing.

    Args:
        change: How each of them is changed.
        photograph: Display sRGB in [0, 1].

    Returns:
        Display sRGB in [0, 1].
    """
    lit = rgb_to_linear_rgb(photograph) * expand_colour(change.gain)
    display = grade(change.processing, apply_tone_curve(change.tone, lit))
    return compress(resample(change.processing, display), change.quality)
