"""Scenes of faces fitted to scans: their parameters, views and pictures."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float, Int8, Int64, UInt8
from numpy.typing import NDArray
from torch import Tensor

from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.mesh import read_mesh
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.physics import SkinDecoder
from skinnet.render import Scene, frame_face, trace_geometry
from train.batch import Batch
from train.synthetic.casts.head_cast import cast_surface
from train.synthetic.photography.renderer import (
    VisibleSkin,
    decode_normals,
    decode_sky_visibility,
    develop,
)
from train.synthetic.photography.shading import shade
from train.synthetic.photography.simulated_camera import simulate_sensor
from train.synthetic.scene import CameraParameters, LightParameters, SpecularParameters
from train.synthetic.tensors import expand_colour

_YAW_SD, _PITCH_SD, _FIELD_OF_VIEW = 25.0, 8.0, 24.0
"""Standard deviations of the camera's yaw and pitch, and its field of view, in degrees."""

_OIL = 1.0
"""Oil at every pixel of a fitted face, relative to the oil that is sampled for the picture."""


class FittedView(NamedTuple):
    """Geometry buffers of one face from one camera.

    `hit` is 1 where the camera sees the outside of the face, otherwise 0. `uv` holds texture
    coordinates in the convention of `grid_sample`. All else is as in
    `train.synthetic.scene.HeadBuffers`.
    """

    hit: Float[Tensor, "*batch height width"]
    uv: Float[Tensor, "*batch height width 2"]
    normal: Int8[Tensor, "*batch height width 3"]
    sky_visibility: UInt8[Tensor, "*batch height width"]
    visibility_mask: Int64[Tensor, "*batch height width"]


class FittedScene(NamedTuple):
    """A view of a face, and all that is sampled for one picture of it.

    `texture` holds hemoglobin, melanin and offset, `known` the share of each texel that is known,
    `wall` the linear sRGB of the background.
    """

    view: FittedView
    texture: Float[Tensor, "*batch 5 texels texels"]
    known: Float[Tensor, "*batch 1 texels texels"]
    wall: Float[Tensor, "*batch 3"]
    specular: SpecularParameters
    light: LightParameters
    camera: CameraParameters


def average_texels(
    texture: SkinTexture, texels: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Average the known texels of a skin texture.

    Args:
        texture: The texture, square.
        texels: Side of the result.

    Returns:
        Means [5, texels, texels] of hemoglobin, melanin and offset, and the share of known texels
        [texels, texels].
    """
    known = torch.from_numpy(texture.mask)[None, None].float()
    features = torch.from_numpy(texture.features()).reshape(1, 5, *texture.mask.shape)
    share = F.adaptive_avg_pool2d(known, texels)
    mean = F.adaptive_avg_pool2d(features, texels) / share.clamp_min(1e-6)
    return mean[0].numpy(), share[0, 0].numpy()


def cast_views(path: Path, count: int, size: int, rng: np.random.Generator) -> list[FittedView]:
    """Ray-cast a textured face from several viewpoints.

    Args:
        path: File of the face's mesh.
        count: Number of views; the first is from ahead.
        size: Side of the pictures in pixels.
        rng: Random numbers.

    Returns:
        The views.

    Raises:
        InputError: If the mesh has no texture coordinates.
    """
    scene = Scene(read_mesh(path))
    if scene.mesh.uv is None:
        raise InputError(f"{path} has no texture coordinates; `skinnet maps` writes such faces.")
    angles = rng.normal(0, (_YAW_SD, _PITCH_SD), (count, 2)).clip((-60, -20), (60, 20))
    angles[0] = 0
    return [_cast_view(scene, size, float(yaw), float(pitch)) for yaw, pitch in angles]


def _cast_view(scene: Scene, size: int, yaw: float, pitch: float) -> FittedView:
    camera = frame_face(scene.mesh.vertices, (size, size), yaw, pitch, _FIELD_OF_VIEW)
    surface = trace_geometry(scene, camera)
    assert surface.uv is not None  # `cast_views` has checked it.
    front, uv = np.zeros((size, size), np.float32), np.zeros((size, size, 2), np.float32)
    normal, sky = np.zeros((size, size, 3), np.int8), np.zeros((size, size), np.uint8)
    mask = np.full((size, size), -1, np.int64)
    hit = surface.hit
    front[hit] = surface.side[:, 0] > 0
    uv[hit] = np.column_stack([2 * surface.uv[:, 0] - 1, 1 - 2 * surface.uv[:, 1]])
    cast = cast_surface(surface, camera.rotation)
    normal[hit], sky[hit] = cast.normal, cast.sky_visibility
    mask[hit] = cast.visibility_mask.view(np.int64)
    return FittedView(*(torch.from_numpy(one) for one in (front, uv, normal, sky, mask)))


@torch.no_grad()
def render_fitted(scene: FittedScene, decoder: SkinDecoder, split: str = "train") -> Batch:
    """Render photographs and their truth, as `train.synthetic.photography.renderer.render` does.

    Args:
        scene: A batch of scenes.
        decoder: Computes the colours of skin.
        split: Train, val or test, each with its own cameras.

    Returns:
        Photographs, masks, true maps, captures and albedo.
    """
    view = scene.view
    layers = torch.cat([scene.texture, scene.known], 1)
    values = F.grid_sample(layers, view.uv, align_corners=False)
    blood, melanin, offset, known = values.split([1, 1, 3, 1], 1)
    melanin, blood = melanin[:, 0].clamp(0, F_MEL_MAX), blood[:, 0].clamp(0, F_BLOOD_MAX)
    hit = view.hit[:, None]
    share = hit * (known > 0.5)
    shading = shade(
        scene.light,
        scene.specular,
        decode_normals(view.normal),
        decode_sky_visibility(view.sky_visibility),
        view.visibility_mask,
        torch.full_like(share, _OIL),
    )
    matrix, capture = simulate_sensor(scene.light, scene.camera, decoder.camera, split)
    white = expand_colour(matrix.sum(-2))
    # Eyes and mouth are holes or unknown; the wall is lit evenly.
    other = white * (expand_colour(scene.wall) * (1 - hit) + hit * 0.05 * shading.diffuse)
    skin = VisibleSkin(melanin, blood, decoder.albedo(melanin, blood, matrix), share, shading)
    rest = share * shading.diffuse * offset + (1 - share) * other
    return develop(scene.camera, skin, rest, white, capture, decoder.camera)
