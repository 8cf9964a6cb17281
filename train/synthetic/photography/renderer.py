"""Renders photographs and their ground truth from scene parameters."""

from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float, Int8, Int64, UInt8
from torch import Tensor

from skinnet.network.autoencoder import SHADING_MAX, SkinMaps
from skinnet.physics import Capture, SkinDecoder, SpectralCamera, luminance
from skinnet.shape._procedural_head import CHART_EXTENT
from train.batch import Batch
from train.synthetic.labels import BODY, FILM, MATERIALS, SKIN
from train.synthetic.painting.body_painting import paint_body
from train.synthetic.painting.face_painting import FaceCharts, paint_face
from train.synthetic.painting.garment_colours import reflect_in_lenses
from train.synthetic.painting.materials import OIL, colour_materials, colour_wall
from train.synthetic.painting.paintings import Paintings, find_paintings, merge_paintings
from train.synthetic.photography.known_capture import find_white_balance, tell_capture
from train.synthetic.photography.shading import Shading, shade
from train.synthetic.photography.simulated_camera import (
    photograph_white,
    simulate_sensor,
    take_photograph,
)
from train.synthetic.scene import (
    CameraParameters,
    FaceParameters,
    SceneParameters,
    map_tensors,
)
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
        scene: A batch of scenes, mild ones or those of `collate_scenes`.
        decoder: Computes the colours of skin.
        split: Train, val or test, each with its own cameras.

    Returns:
        Photographs, masks, true maps, captures and albedo.

    Raises:
        ValueError: If faces and the paintings that the labels name differ in number.
    """
    head, paintings = scene.head, find_paintings(scene.head.label)
    matrix, capture = simulate_sensor(scene.light, scene.camera, decoder.camera, split)
    surface = _paint(scene, paintings, decoder, matrix)
    material = (head.label % FILM)[:, None]
    film = (head.label % MATERIALS >= FILM)[:, None].float()
    skin = (material == SKIN).float()
    first = paintings.first
    specular = map_tensors(lambda value: value[first], scene.face.skin.specular)
    surroundings = map_tensors(lambda value: value[first], scene.surroundings)
    shading = shade(
        scene.light,
        specular,
        normalise(decode_normals(head.normal) + skin * F.pad(surface.bump, (0, 0, 0, 0, 0, 1))),
        decode_sky_visibility(head.sky_visibility),
        head.visibility_mask,
        torch.where(skin > 0, surface.oil, OIL.to(skin)[material.long()]),
    )
    white = expand_colour(matrix.sum(-2))
    # The wall has its own light.
    wall = colour_wall(surroundings, material.shape[-2:])
    lit = surface.other * shading.diffuse + shading.specular
    if shading.tint is not None:
        wall = wall * expand_colour(scene.light.tints[:, 0].exp())
        lit = lit * shading.tint
    other = torch.where(material > 0, lit, wall) * white
    share = skin * (1 - surface.cover)
    visible = VisibleSkin(
        surface.melanin[:, 0], surface.hemoglobin[:, 0], surface.albedo, share, shading
    )
    rest = (1 - share) * other
    if film.any():
        reflected = reflect_in_lenses(scene.face.garments, paintings.first, scene.light.sky, film)
        rest = rest + reflected * white
    return develop(scene.camera, visible, rest, white, capture, decoder.camera)


class _Surface(NamedTuple):
    """What is painted on the surfaces of a batch of pictures, without light.

    `other` is the linear sRGB of all that is not skin, and `cover` its share on skin.
    """

    melanin: Map
    hemoglobin: Map
    albedo: Image
    other: Image
    cover: Map
    oil: Map
    bump: Float[Tensor, "batch 2 height width"]


def _paint(
    scene: SceneParameters,
    paintings: Paintings,
    decoder: SkinDecoder,
    matrix: Float[Tensor, "batch wavelength 3"],
) -> _Surface:
    picture, skin = paintings.picture, scene.face.skin
    if len(picture) != len(skin.melanin.fraction):
        raise ValueError(
            f"The labels have {len(picture)} paintings and the scene has "
            f"{len(skin.melanin.fraction)} faces; sample it with the variety of its heads, and "
            "collate scenes of the variety any by collate_scenes."
        )
    label = (scene.head.label % FILM)[picture, None].float()
    place = scene.head.chart.movedim(-1, 1).float()[picture]
    charts = _sample_charts(_paint_charts(scene.face, paintings.number), place)
    varied = any(bool(deviation.any()) for deviation in skin.nuisance)
    # A last row of each map has the base fractions, whose colour some garments share.
    f_mel, f_blood = (
        torch.cat([one[:, 0], base.fraction[:, None, None].expand(-1, 1, one.shape[3])], 1)
        for one, base in ((charts.melanin, skin.melanin), (charts.hemoglobin, skin.hemoglobin))
    )
    albedo = decoder.albedo(f_mel, f_blood, matrix[picture], skin.nuisance if varied else None)
    albedo, own_skin = albedo[:, :, :-1], albedo[:, :, -1:, :1]
    own_skin = own_skin / expand_colour(matrix.sum(-2))[picture]
    other = colour_materials(scene, label, place, charts.cover_colour, own_skin)
    # A picture has one amount of oil, that of its first painting.
    oil = skin.specular.oil / skin.specular.oil[paintings.first][picture]
    surface = _Surface(
        charts.melanin,
        charts.hemoglobin,
        albedo,
        other,
        charts.cover,
        charts.oil * expand_scalar(oil),
        charts.bump,
    )
    if paintings.single:
        return surface
    return _Surface(*(merge_paintings(paintings, one) for one in surface))


def _paint_charts(face: FaceParameters, number: Int64[Tensor, "paintings"]) -> FaceCharts:
    """Paint faces, and bodies where the number says so."""
    body = (number >= BODY).nonzero()[:, 0]
    if not len(body):
        return paint_face(face)
    heads = (number < BODY).nonzero()[:, 0]
    bodies = paint_body(map_tensors(lambda value: value[body], face))
    if not len(heads):
        return bodies
    faces = paint_face(map_tensors(lambda value: value[heads], face))
    charts = FaceCharts(*(one.new_empty(len(number), *one.shape[1:]) for one in faces))
    for whole, own, other in zip(charts, faces, bodies, strict=True):
        whole[heads], whole[body] = own, other
    return charts


def develop(
    camera: CameraParameters,
    skin: VisibleSkin,
    rest: Image,
    white: Image,
    capture: Capture,
    model: SpectralCamera,
) -> Batch:
    """Photograph skin and everything else, and assemble the ground truth.

    Args:
        camera: Exposure and all that follows the sensor.
        skin: Skin and its light.
        rest: Linear light of all that is not skin.
        white: Linear sRGB of a white diffuser, [batch, 3, 1, 1].
        capture: Light and camera, returned with the white balance and the exposure that the
            photograph shows.
        model: Statistical model of cameras.

    Returns:
        Photographs, masks, true maps, captures and albedo.
    """
    diffuse, specular, tint = skin.shading
    lit = skin.share * (skin.albedo * diffuse + specular * white)
    linear = (lit if tint is None else lit * tint) + rest
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
    seen = photograph_white(camera, (gain * white)[..., 0, 0])
    capture = capture._replace(
        white_balance=find_white_balance(seen, model),
        linear=camera.linear,
        exposure=luminance(seen[..., None, None])[:, 0, 0, 0].log(),
    )
    batch = Batch(
        photograph,
        truth.mask,
        truth,
        capture,
        skin.albedo,
        known=tell_capture(camera, capture),
    )
    return _mirror(batch, camera.mirror > 0)


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
    return batch._replace(
        photograph=mirror(batch.photograph),
        mask=truth.mask,
        truth=truth,
        albedo=mirror(batch.albedo),
    )
