"""The cameras that were measured, and what they do to linear light."""

from functools import cache

import numpy as np
import torch
from jaxtyping import Float
from kornia.enhance import jpeg_codec_differentiable
from kornia.filters import gaussian_blur2d
from torch import Tensor

from skinnet.physics import Capture, SpectralCamera, load_cameras, spectrum_to_srgb, to_display
from train.synthetic.tensors import column

HELD_OUT = 10
"""Cameras that only the test split uses."""

PIVOT = 0.18
"""Linear value that the tone curve's contrast leaves where it is."""

Image = Float[Tensor, "batch 3 height width"]


@cache
def numbers(split: str) -> tuple[int, ...]:
    """Places in the table of the cameras of a split: the test's are its own."""
    order = np.random.default_rng(0).permutation(len(load_cameras()))
    mine = order[:HELD_OUT] if split == "test" else order[HELD_OUT:]
    return tuple(sorted(int(place) for place in mine))


def pictured(
    lot: dict[str, Tensor], camera: SpectralCamera, split: str
) -> tuple[Float[Tensor, "batch wavelength 3"], Capture]:
    """The map of each lot from spectra to linear sRGB by a measured camera, and its capture, in
    which the camera is the nearest that the basis can say."""
    places = torch.tensor(numbers(split), device=lot["pick"].device)
    chosen = places[(lot["pick"] * len(places)).long().clamp_max(len(places) - 1)]
    curves = torch.stack(list(load_cameras().values())).to(camera.mean)[chosen]
    light = camera.mix_lights(lot["light"], lot["temperature"])
    red, blue = lot["white_balance"].unbind(-1)
    gain = torch.stack([red, torch.zeros_like(red), blue], -1).exp()
    matrix = spectrum_to_srgb(light, curves, camera.observer, gain)
    capture = Capture(
        lot["light"], lot["temperature"], _coefficients(curves, camera), lot["white_balance"]
    )
    return matrix, capture


def _coefficients(
    curves: Float[Tensor, "batch wavelength 3"], camera: SpectralCamera
) -> Float[Tensor, "batch components"]:
    basis = camera.basis.flatten(1)
    return (curves - camera.mean).flatten(1) @ (basis / (basis**2).sum(1, keepdim=True)).T


def photographed(lot: dict[str, Tensor], linear: Image) -> Image:
    """Display sRGB of linear light: lens, tone curve, noise, compression, eight bits."""
    sigma = (lot["blur"] * linear.shape[-1] / 192)[:, None].expand(-1, 2)
    display = toned(lot, gaussian_blur2d(linear.clamp_min(0), 7, sigma))
    spread = column(lot["noise"][:, 0]) + column(lot["noise"][:, 1]) * (1 - display)
    noisy = (display + spread * lot["grain"]).clamp(0, 1)
    return (_compressed(noisy, lot["quality"]) * 255).round() / 255


def toned(lot: dict[str, Tensor], linear: Image) -> Image:
    """Display sRGB of linear light by a camera's tone curve."""
    contrast, bend = (column(part) for part in lot["tone"].unbind(1))
    display = to_display(PIVOT * (linear / PIVOT + 1e-6) ** contrast.exp())
    return (display + bend * display * (1 - display) * (2 * display - 1)).clamp(0, 1)


def _compressed(display: Image, quality: Float[Tensor, "batch"]) -> Image:
    some = quality.nonzero()[:, 0]
    if not len(some):
        return display
    pad = [-side % 16 for side in display.shape[:1:-1]]
    wide = torch.nn.functional.pad(display[some], (0, pad[0], 0, pad[1]), mode="replicate")
    coded = jpeg_codec_differentiable(wide, quality[some])
    coded = coded[..., : display.shape[-2], : display.shape[-1]].clamp(0, 1)
    return display.index_copy(0, some, coded.to(display))
