"""Surfaces under lights as pictures."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Shaped, UInt8

from skinnet.errors import InputError
from skinnet.images.photograph import linear_to_srgb, to_uint8
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.normals import normalise
from skinnet.mesh.sampling import sample_bilinear
from skinnet.render.lights import Light
from skinnet.render.scene import Scene
from skinnet.render.views import View
from skinnet.render.visibility import GeometryBuffers, trace_geometry

SKIN_SPECULAR = 0.028
"""Reflectance at normal incidence of skin, refractive index 1.4."""

EXPONENT = 20.0
"""Of the highlight; skin is rough."""

Albedo = Shaped[np.ndarray, "rows columns 3"] | Float[np.ndarray, "3"]


class ShadedImage(NamedTuple):
    """Linear light on black, and the share of each pixel that the mesh covers."""

    image: Float[np.ndarray, "height width 3"]
    alpha: Float[np.ndarray, "height width"]


def shade(
    buffers: GeometryBuffers,
    albedo: Albedo,
    lights: Sequence[Light],
    shadows: bool = True,
    specular: float = 0.0,
) -> ShadedImage:
    """A diffuse surface under lights, in linear sRGB: albedo times irradiance over pi.

    `albedo` is a linear texture [n, m, 3] looked up at the mesh's texture coordinates, or one
    colour [3]. `specular` adds to each directional light a normalised Blinn-Phong highlight of that
    reflectance (`SKIN_SPECULAR`) and of `EXPONENT`: specular (m + 8) / 8 (n . h)^m times the light.
    Samples are averaged over each pixel in linear light.

    Raises `InputError` for a texture and a mesh without texture coordinates.
    """
    colour = _albedo(buffers, albedo)
    light = np.zeros_like(buffers.position)
    gloss = np.zeros_like(light)
    for lamp in lights:
        irradiance, direction = lamp.arrive(buffers, shadows)
        light += irradiance
        if specular and direction is not None:
            halfway = normalise(buffers.towards + direction)
            cosine = np.einsum("px,px->p", buffers.normal, halfway).clip(0)
            gloss += irradiance * (specular * (EXPONENT + 8) / 8 * cosine**EXPONENT)[:, None]
    return _pixels(buffers, colour * light + gloss)


def render(
    mesh: Mesh | Scene,
    albedo: Albedo,
    lights: Sequence[Light],
    view: View,
    samples: int = 2,
    shadows: bool = True,
    specular: float = 0.0,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> UInt8[np.ndarray, "height width 3"]:
    """A picture as uint8 sRGB: `relight` of what the view sees, `samples` x `samples` a pixel.

    Light above 1 is clipped; `background` is linear.
    """
    relit = shade(trace_geometry(mesh, view, samples), albedo, lights, shadows, specular)
    behind = (1 - relit.alpha)[..., None] * np.array(background)
    return to_uint8(linear_to_srgb(relit.image + behind))


def _albedo(buffers: GeometryBuffers, albedo: Albedo) -> Float[np.ndarray, "hits 3"]:
    if albedo.ndim == 1:
        return np.broadcast_to(albedo, buffers.position.shape)
    if buffers.uv is None:
        raise InputError(
            f"{buffers.scene.mesh.name} has no texture coordinates to look an albedo texture up "
            "at; give one colour, or a mesh with texture coordinates."
        )
    return sample_bilinear(albedo, buffers.uv)


def _pixels(buffers: GeometryBuffers, values: Float[np.ndarray, "hits 3"]) -> ShadedImage:
    """Means over the samples of each pixel."""
    height, width = (side // buffers.samples for side in buffers.hit.shape)
    sampled = np.zeros((*buffers.hit.shape, 4))
    sampled[buffers.hit, :3] = values
    sampled[buffers.hit, 3] = 1
    blocks = sampled.reshape(height, buffers.samples, width, buffers.samples, 4)
    mean = blocks.mean((1, 3))
    return ShadedImage(mean[..., :3], mean[..., 3])
