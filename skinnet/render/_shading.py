"""Shading: the light that a surface reflects to the viewer."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Shaped

from skinnet.errors import InputError
from skinnet.mesh._sampling import sample_bilinear
from skinnet.mesh._vectors import normalise
from skinnet.render.lights import Light
from skinnet.render.visibility import GeometryBuffers

EXPONENT = 20.0
"""Exponent of the highlight; a low one, because skin is rough."""

_Albedo = Shaped[np.ndarray, "rows columns 3"] | Float[np.ndarray, "3"]


class ShadedImage(NamedTuple):
    """Linear RGB on a black background, and the share of each pixel that the mesh covers."""

    image: Float[np.ndarray, "height width 3"]
    alpha: Float[np.ndarray, "height width"]


def shade(
    buffers: GeometryBuffers,
    albedo: _Albedo,
    lights: Sequence[Light],
    shadows: bool = True,
    specular: float = 0.0,
) -> ShadedImage:
    """Shade a diffuse surface, in linear sRGB: albedo times irradiance over pi.

    With `specular`, each directional light adds a normalised Blinn-Phong highlight with exponent m
    (`EXPONENT`): specular (m + 8) / 8 (n . h)^m times its irradiance. The samples of each pixel are
    averaged in linear light.

    Raises:
        InputError: For an albedo texture and a mesh without texture coordinates.
    """
    colour = _look_up(buffers, albedo)
    light = np.zeros_like(buffers.position)
    gloss = np.zeros_like(light)
    for lamp in lights:
        irradiance, direction = lamp.illuminate(buffers, shadows)
        light += irradiance
        if specular and direction is not None:
            halfway = normalise(buffers.view_direction + direction)
            cosine = np.einsum("px,px->p", buffers.normal, halfway).clip(0)
            gloss += irradiance * (specular * (EXPONENT + 8) / 8 * cosine**EXPONENT)[:, None]
    return _average_samples(buffers, colour * light + gloss)


def _look_up(buffers: GeometryBuffers, albedo: _Albedo) -> Float[np.ndarray, "hits 3"]:
    if albedo.ndim == 1:
        return np.broadcast_to(albedo, buffers.position.shape)
    if buffers.uv is None:
        raise InputError(
            f"{buffers.scene.mesh.name} has no texture coordinates, which an albedo texture needs; "
            "give one colour, or a mesh with texture coordinates."
        )
    return sample_bilinear(albedo, buffers.uv)


def _average_samples(buffers: GeometryBuffers, values: Float[np.ndarray, "hits 3"]) -> ShadedImage:
    height, width = (side // buffers.samples for side in buffers.hit.shape)
    sampled = np.zeros((*buffers.hit.shape, 4))
    sampled[buffers.hit, :3] = values
    sampled[buffers.hit, 3] = 1
    blocks = sampled.reshape(height, buffers.samples, width, buffers.samples, 4)
    mean = blocks.mean((1, 3))
    return ShadedImage(mean[..., :3], mean[..., 3])
