"""Lights and cameras as wide as photographs by anybody: their spreads are those of real portraits.

`benchmarks.constancy` compares the spreads of skin's colour over two captures of one person with
those of portraits of the same people by two photographers.
"""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.physics import LIGHTS
from train.synthetic.scene import (
    LAMPS,
    SOURCES,
    CameraParameters,
    KnownParameters,
    LightParameters,
    ProcessingParameters,
    map_tensors,
)
from train.synthetic.tensors import make_tensors

_MIRED_ERRORS = ((0.45, 5.0), (0.38, 12.0), (0.17, 30.0))
"""Shares and standard deviations of the error of the assumed white, in mired."""

_GREEN_ERRORS = ((0.7, 0.008), (0.3, 0.025))
"""The same of the log error of green, which is common to R/G and B/G."""

_SATURATION, _SATURATION_SD = 0.08, 0.06
_TONE = np.array(((0.14, 0.5), (0.05, 0.15)))
"""Means, and standard deviations, of log contrast and bend of tone curves."""

_COLOURLESS_SHARE = 0.015
_LINEAR_SHARE = 0.12
_MIXED_SHARE, _COLOURED_SHARE, _FLASH_SHARE = 0.35, 0.04, 0.15

WARMING = np.array([0.0035, 0.0, -0.0065])
"""Log R, G and B of linear sRGB per mired that a light is warmer."""

_BLIND_SHARE, _ALL_SHARE, _KNOWN_SHARE = 0.4, 0.15, 0.6
"""Shares of pictures of which nothing is known, and light, camera and white are; and of the others,
the share that knows a part."""


def sample_processing(
    rng: np.random.Generator, saturation: float = _SATURATION
) -> ProcessingParameters:
    """Sample what is done to a photograph after its tone curve, in float64.

    Args:
        rng: Random numbers.
        saturation: Mean log factor on the distance from grey.

    Returns:
        The processing.
    """
    saturation = rng.normal(saturation, _SATURATION_SD)
    if rng.random() < _COLOURLESS_SHARE:
        saturation = np.log(rng.uniform(0.05, 0.5))
    toned = rng.choice([0.01, 0.04], p=(0.7, 0.3))
    reduced = rng.random() < 0.5
    return ProcessingParameters(
        **make_tensors(
            flare=rng.choice([0.0, rng.uniform(0, 0.04)]),
            saturation=saturation,
            toning=rng.normal(0, toned, (2, 3)),
            reduction=reduced * rng.uniform(0, np.log(4)),
            sharpening=rng.choice([0.0, rng.uniform(0, 1.2)], p=(0.6, 0.4)),
        )
    )


def make_no_processing() -> ProcessingParameters:
    """Make the processing of mild captures and of linear pictures, in float32."""
    zero = torch.tensor(0.0)
    return ProcessingParameters(zero, zero, torch.zeros(2, 3), zero, zero)


def sample_known(rng: np.random.Generator, linear: bool) -> KnownParameters:
    """Sample what the network is told of a capture, in float64."""
    others = 1 - _BLIND_SHARE - _ALL_SHARE
    share = rng.choice([0, 1, _KNOWN_SHARE], p=(_BLIND_SHARE, _ALL_SHARE, others))
    white, light, temperature, camera = rng.random(4) < share
    return KnownParameters(
        **make_tensors(
            white=float(white),
            light=float(light),
            temperature=float(temperature),
            camera=float(camera),
            linear=float(linear and rng.random() < 0.7),
            exposure=float(white and rng.random() < _KNOWN_SHARE),
            reflectance=np.exp(rng.uniform(np.log(0.15), np.log(0.95))),
            white_error=rng.normal(0, rng.choice([0.004, 0.015]), 2),
            light_error=rng.normal(0, 0.15),
        )
    )


def make_nothing_known() -> KnownParameters:
    """Make the knowledge of mild captures, in float32: none."""
    zero = torch.tensor(0.0)
    none = zero, zero, zero, zero, zero, zero
    return KnownParameters(*none, torch.tensor(0.5), torch.zeros(2), zero)


def widen_light(light: LightParameters, rng: np.random.Generator) -> LightParameters:
    """Change the spectrum of a light, and at random mix its sources, colour them, or add a flash.

    Args:
        light: A light of `sample_light`.
        rng: Random numbers.

    Returns:
        The light in float32.
    """
    if rng.random() < _FLASH_SHARE:
        light = _add_flash(light, rng)
    sky, strength = light.sky.numpy()[0], light.strength.numpy()
    changed = make_tensors(
        mixture=_sample_mixture(rng),
        temperature=1e6 / np.clip(rng.normal(165, 35), 45, 245),
        tints=_sample_tints(rng, np.r_[sky, strength]),
    )
    return map_tensors(torch.Tensor.float, light._replace(**changed))


def widen_camera(camera: CameraParameters, rng: np.random.Generator) -> CameraParameters:
    """Give a camera larger errors, processing, and what the network is told of it.

    Args:
        camera: A camera of `sample_camera`.
        rng: Random numbers.

    Returns:
        The camera in float32.
    """
    linear = bool(rng.random() < _LINEAR_SHARE)
    green = _sample_mixed_normal(rng, _GREEN_ERRORS)
    processing = sample_processing(rng)
    changed = make_tensors(
        white_balance=rng.normal(green, 0.008, 2),
        mired_error=_sample_mixed_normal(rng, _MIRED_ERRORS),
        exposure=np.exp(rng.normal(0, 0.14)),
        metering=rng.uniform(0.7, 1.0),
        tone=rng.normal(*_TONE).clip(max=0.95) * (not linear),
        noise=rng.uniform(0, 1, 2) ** 2 * (0.020, 0.024),
        quality=rng.choice([0, rng.uniform(20, 95)], p=(0.3, 0.7)),
        linear=float(linear),
    )
    wide = camera._replace(
        **changed,
        processing=make_no_processing() if linear else processing,
        known=sample_known(rng, linear),
    )
    return map_tensors(torch.Tensor.float, wide)


def _add_flash(light: LightParameters, rng: np.random.Generator) -> LightParameters:
    """Make the first lamp a small one beside the camera, brighter than all other light."""
    place = np.r_[rng.normal((0, 0.12), 0.08), 1.0]
    lamps, strength, softness = (
        one.clone() for one in (light.lamps, light.strength, light.softness)
    )
    lamps[0] = torch.from_numpy(place / np.linalg.norm(place))
    strength[1:] *= 0.4
    strength[0] = rng.uniform(0.4, 0.9)
    softness[0] = rng.uniform(0.06, 0.15)
    return light._replace(lamps=lamps, strength=strength, softness=softness, sky=0.5 * light.sky)


def _sample_mixture(rng: np.random.Generator) -> Float[np.ndarray, "lights"]:
    """Mostly one light; daylight in more than three of four pictures."""
    first = 0 if rng.random() < 0.75 else rng.integers(1, len(LIGHTS))
    mixture = rng.dirichlet(np.full(len(LIGHTS), 0.3)) * rng.choice([0, rng.uniform(0, 0.5)])
    mixture[first] += 1 - mixture.sum()
    return np.asarray(mixture)


def _sample_tints(
    rng: np.random.Generator, power: Float[np.ndarray, "{SOURCES}"]
) -> Float[np.ndarray, "{SOURCES} 3"]:
    """Tints whose mean over all light is about neutral, as a camera balances it."""
    tints = np.zeros((SOURCES, 3))
    if rng.random() < _MIXED_SHARE:
        tints += rng.normal(0, 40, (SOURCES, 1)) * WARMING
    if rng.random() < _COLOURED_SHARE:
        tints[1 + rng.integers(LAMPS)] += rng.normal(0, 0.5, 3)
    tints -= tints[:, 1:2]
    return np.asarray(tints - power @ tints / power.sum())


def _sample_mixed_normal(rng: np.random.Generator, parts: tuple[tuple[float, float], ...]) -> float:
    shares, deviations = zip(*parts, strict=True)
    return float(rng.normal(0, rng.choice(deviations, p=shares)))
