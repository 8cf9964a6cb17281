"""Cameras of the synthetic renderer: measured sensors, and all that follows them."""

from functools import cache

import numpy as np
import torch
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from kornia.enhance import jpeg_codec_differentiable
from kornia.filters import gaussian_blur2d
from torch import Tensor

from skinnet.physics import Capture, SpectralCamera, load_cameras, spectrum_to_srgb, to_display
from skinnet.physics.spectra import WAVELENGTHS
from train.synthetic.photography.processing import add_flare, grade, resample
from train.synthetic.scene import CameraParameters, LightParameters
from train.synthetic.tensors import expand_scalar

HELD_OUT = 10
"""Number of measured cameras that only the test split uses."""

_USUAL_MIRED = torch.tensor(180.0)
"""Light of 5,556 K, whose white is mistaken."""

BRIGHTEST = 0.85
"""Linear value of the brightest reference before the tone curve."""

_PIVOT = 0.18
"""Linear value that the contrast of the tone curve does not change."""

Image = Float[Tensor, "batch 3 height width"]


@cache
def select_sensors(split: str) -> tuple[int, ...]:
    """Select the measured cameras of a split; train and val share theirs, test has its own.

    Args:
        split: Train, val or test.

    Returns:
        Rows of the table of cameras.
    """
    order = np.random.default_rng(0).permutation(len(load_cameras()))
    selected = order[:HELD_OUT] if split == "test" else order[HELD_OUT:]
    return tuple(sorted(int(row) for row in selected))


def simulate_sensor(
    light: LightParameters, camera: CameraParameters, model: SpectralCamera, split: str
) -> tuple[Float[Tensor, "batch wavelength 3"], Capture]:
    """Compute the colour matrices of measured sensors under sampled lights.

    Args:
        light: Spectrum of each picture's light.
        camera: Sensor and white balance of each picture.
        model: Statistical model of cameras, whose basis describes the sensor of a capture.
        split: Train, val or test.

    Returns:
        The matrices from reflectance spectra to linear sRGB, and the captures. A capture describes
        its sensor by the nearest one in the model's basis.
    """
    rows = torch.tensor(select_sensors(split), device=camera.sensor.device)
    chosen = rows[(camera.sensor * len(rows)).long().clamp_max(len(rows) - 1)]
    curves = torch.stack(list(load_cameras().values())).to(model.mean)[chosen]
    spectrum = model.mix_lights(light.mixture, light.temperature)
    white_balance = camera.white_balance + _mistake_light(curves, camera.mired_error)
    red, blue = white_balance.unbind(-1)
    gain = torch.stack([red, torch.zeros_like(red), blue], -1).exp()
    matrix = spectrum_to_srgb(spectrum, curves, model.observer, gain)
    coefficients = _project(curves, model)
    return matrix, Capture(light.mixture, light.temperature, coefficients, white_balance)


def _mistake_light(
    curves: Float[Tensor, "batch wavelength 3"], mired_error: Float[Tensor, "batch"]
) -> Float[Tensor, "batch 2"]:
    """Log errors of R/G and B/G of sensors that take the light for a warmer black body."""
    wavelength = WAVELENGTHS.to(curves)
    usual, taken = (
        (curves * _radiate(wavelength, mired)[..., None]).sum(1).log()
        for mired in (_USUAL_MIRED.to(curves).expand(len(curves)), _USUAL_MIRED + mired_error)
    )
    red, green, blue = (usual - taken).unbind(-1)
    error = torch.stack([red - green, blue - green], -1)
    # Exactly 0 without an error.
    return torch.where(mired_error[:, None] == 0, torch.zeros_like(error), error)


def _radiate(
    wavelength: Float[Tensor, "wavelength"], mired: Float[Tensor, "batch"]
) -> Float[Tensor, "batch wavelength"]:
    """Relative power of black bodies of the inverse temperature in mired, by Planck's law."""
    exponent = 14.388 * mired.clamp_min(20)[:, None] / wavelength
    power = wavelength**-5 / exponent.expm1()
    return power / power.sum(-1, keepdim=True)


def _project(
    curves: Float[Tensor, "batch wavelength 3"], model: SpectralCamera
) -> Float[Tensor, "batch components"]:
    basis = model.basis.flatten(1)
    return (curves - model.mean).flatten(1) @ (basis / (basis**2).sum(1, keepdim=True)).T


def take_photograph(camera: CameraParameters, linear: Image) -> Image:
    """Turn linear light into a photograph: lens blur, tone curve, processing, noise, eight bits.

    Args:
        camera: What each picture's camera does.
        linear: Linear sRGB, 0 or more.

    Returns:
        Display sRGB in [0, 1].
    """
    sigma = (camera.blur * linear.shape[-1] / 192)[:, None].expand(-1, 2)
    processing = camera.processing
    sharp = gaussian_blur2d(linear.clamp_min(0), 7, sigma)
    display = process(camera, sharp)
    white, dark = (expand_scalar(part) for part in camera.noise.unbind(1))
    spread = white + dark * (1 - display)
    noisy = (display + spread * camera.grain).clamp(0, 1)
    resampled = resample(processing, noisy)
    return (compress(resampled, camera.quality) * 255).round() / 255


def photograph_white(
    camera: CameraParameters, white: Float[Tensor, "batch 3"]
) -> Float[Tensor, "batch 3"]:
    """Photograph a white or grey reference in the scene's light.

    A reference that would be overexposed is replaced by a darker one, as a photographer would.

    Args:
        camera: What each picture's camera does, and the reference.
        white: Linear sRGB of a white diffuser in the light of the skin, before the tone curve.

    Returns:
        Linear sRGB of white in the photograph: that of the reference, without noise, over its
        reflectance.
    """
    bright = white.amax(-1) * camera.known.light_error.exp()
    reflectance = camera.known.reflectance.minimum(BRIGHTEST / bright)
    share = expand_scalar(reflectance * camera.known.light_error.exp())
    display = process(camera, (share * white[..., None, None]).clamp_min(1e-3))
    seen: Tensor = rgb_to_linear_rgb(display)[..., 0, 0]
    return seen / reflectance[:, None]


def process(camera: CameraParameters, linear: Image) -> Image:
    """Turn light on the sensor into display sRGB: stray light, tone curve, grading; no noise.

    Args:
        camera: What each picture's camera does.
        linear: Linear sRGB, 0 or more.

    Returns:
        Display sRGB in [0, 1].
    """
    lit = add_flare(camera.processing, linear)
    return grade(camera.processing, apply_tone_curve(camera.tone, lit))


def apply_tone_curve(tone: Float[Tensor, "batch 2"], linear: Image) -> Image:
    """Turn linear light into display sRGB by a camera's tone curve.

    Args:
        tone: Log contrast, and bend of the curve.
        linear: Linear sRGB, 0 or more.

    Returns:
        Display sRGB in [0, 1].
    """
    contrast, bend = (expand_scalar(part) for part in tone.unbind(1))
    display = to_display(_PIVOT * (linear / _PIVOT + 1e-6) ** contrast.exp())
    return (display + bend * display * (1 - display) * (2 * display - 1)).clamp(0, 1)


def compress(display: Image, quality: Float[Tensor, "batch"]) -> Image:
    """Compress pictures as JPEG of a quality in [1, 100]; 0 leaves a picture as it is."""
    chosen = quality.nonzero()[:, 0]
    if not len(chosen):
        return display
    pad = [-side % 16 for side in display.shape[:1:-1]]
    padded = torch.nn.functional.pad(display[chosen], (0, pad[0], 0, pad[1]), mode="replicate")
    coded = jpeg_codec_differentiable(padded, quality[chosen])
    coded = coded[..., : display.shape[-2], : display.shape[-1]].clamp(0, 1)
    return display.index_copy(0, chosen, coded.to(display))
