"""Renders photographs and their ground truth from scene parameters."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float, Int8, UInt8
from torch import Tensor

from skinnet.network.autoencoder import SHADING_MAX, SkinMaps
from skinnet.physics import Capture, SkinDecoder, luminance
from skinnet.shape._procedural_head import CHART_EXTENT
from train.batch import Batch
from train.synthetic.face_painting import FaceCharts, paint_face
from train.synthetic.labels import SKIN
from train.synthetic.materials import OIL, colour_materials
from train.synthetic.scene import CameraParameters, SceneParameters
from train.synthetic.shading import Shading, shade
from train.synthetic.simulated_camera import simulate_sensor, take_photograph
from train.synthetic.tensors import expand_colour, expand_scalar, normalise

_METERED = 0.25
"""Mean luminance of the skin after full metering."""

Image = Float[Tensor, "batch 3 height width"]
Map = Float[Tensor, "batch 1 height width"]


class VisibleSkin(NamedTuple):
    """Skin in a batch of pictures: pigments, linear sRGB, share of each pixel, and its light."""

    melanin: Float[Tensor, "batch height width"]
    hemoglobin: Float[Tensor, "batch height width"]
    albedo: Image
    share: Map
    shading: Shading


@torch.no_grad()
def render(scene: SceneParameters, decoder: SkinDecoder, split: str = "train") -> Batch:
    """Render photographs and their truth.

    On skin a picture is shading * skin + specular under a measured camera. Elsewhere the true
    shading is 0, and the true offset is the light itself, before lens and tone curve.

    Args:
        scene: A batch of scenes.
        decoder: Computes the colours of skin.
        split: Train, val or test, each with its own cameras.

    Returns:
        Photographs, masks, true maps, captures and albedo.
    """
    head = scene.head
    label, place = head.label[:, None].float(), head.chart.movedim(-1, 1).float()
    charts = _sample_charts(paint_face(scene.face), place)
    skin = (label == SKIN).float()
    share = skin * (1 - charts.cover)
    normal = normalise(decode_normals(head.normal) + skin * F.pad(charts.bump, (0, 0, 0, 0, 0, 1)))
    shading = shade(
        scene.light,
        scene.face.skin.specular,
        normal,
        decode_sky_visibility(head.sky_visibility),
        head.visibility_mask,
        torch.where(skin > 0, charts.oil, OIL.to(skin)[label.long()]),
    )
    matrix, capture = simulate_sensor(scene.light, scene.camera, decoder.camera, split)
    white = expand_colour(matrix.sum(-2))
    melanin, hemoglobin = charts.melanin[:, 0], charts.hemoglobin[:, 0]
    other = colour_materials(scene, label, place, charts.cover_colour)
    # The wall has its own light.
    other = other * torch.where(label > 0, shading.diffuse, 1.0)
    other = (other + shading.specular * (label > 0)) * white
    nuisance = scene.face.skin.nuisance
    varied = any(bool(deviation.any()) for deviation in nuisance)
    albedo = decoder.albedo(melanin, hemoglobin, matrix, nuisance if varied else None)
    visible = VisibleSkin(melanin, hemoglobin, albedo, share, shading)
    return develop(scene.camera, visible, (1 - share) * other, white, capture)


def develop(
    camera: CameraParameters, skin: VisibleSkin, rest: Image, white: Image, capture: Capture
) -> Batch:
    """Photograph skin and everything else, and assemble the ground truth.

    Args:
        camera: Exposure and all that follows the sensor.
        skin: Skin and its light.
        rest: Linear light of all that is not skin.
        white: Linear sRGB of a white diffuser, [batch, 3, 1, 1].
        capture: Light and camera, returned unchanged.

    Returns:
        Photographs, masks, true maps, captures and albedo.
    """
    diffuse, specular = skin.shading
    linear = skin.share * (skin.albedo * diffuse + specular * white) + rest
    gain = _expose(camera, linear, skin.share)
    truth = SkinMaps(
        skin.melanin,
        skin.hemoglobin,
        (gain * skin.share * diffuse)[:, 0].clamp_max(SHADING_MAX),
        (gain * skin.share * specular)[:, 0].clamp_max(1),
        (gain * rest).clamp(-1, 1),
        skin.share[:, 0],
    )
    photograph = take_photograph(camera, gain * linear)
    return _mirror(Batch(photograph, truth.mask, truth, capture, skin.albedo), camera.mirror > 0)


def decode_normals(normal: Int8[Tensor, "batch height width 3"]) -> Image:
    """Turn the normals of buffers into unit vectors; the background's point to the camera."""
    return normalise(normal.movedim(-1, 1).float() + 1e-3)


def decode_sky_visibility(sky_visibility: UInt8[Tensor, "batch height width"]) -> Map:
    """Turn the sky visibility of buffers into shares in [0, 1]."""
    return sky_visibility[:, None].float() / 255


def _sample_charts(charts: FaceCharts, place: Float[Tensor, "batch 2 height width"]) -> FaceCharts:
    """Values of charts at places in azimuth and elevation."""
    grid = torch.stack([place[:, 0] / CHART_EXTENT[0], -place[:, 1] / CHART_EXTENT[1]], -1)
    values = F.grid_sample(torch.cat(charts, 1), grid, align_corners=True, padding_mode="border")
    return FaceCharts(*values.split([one.shape[1] for one in charts], 1))


def _expose(camera: CameraParameters, linear: Image, share: Map) -> Float[Tensor, "batch 1 1 1"]:
    light = luminance(linear)
    mean = (light * share).sum((1, 2, 3)) / share.sum((1, 2, 3)).clamp_min(1)
    correction = (_METERED / mean.clamp(0.01, 1)) ** camera.metering
    return expand_scalar((camera.exposure * correction).clamp(0.15, 5))


def _mirror(batch: Batch, chosen: Tensor) -> Batch:
    """Mirror the chosen pictures and their truth."""
    assert batch.truth is not None and batch.albedo is not None

    def mirror(value: Tensor) -> Tensor:
        where = chosen.reshape(-1, *[1] * (value.ndim - 1))
        return torch.where(where, value.flip(-1), value)

    truth = SkinMaps(*map(mirror, batch.truth))
    return Batch(mirror(batch.photograph), truth.mask, truth, batch.capture, mirror(batch.albedo))
