"""Rendered portraits of people whose pigments are known, in one soft light."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from skinnet.images import resize, to_uint8
from skinnet.mesh import Mesh
from skinnet.physics import SkinDecoder
from skinnet.render import Scene
from train.synthetic.bodies.ict_model import IctModel, read_ict_model
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.casts.head_cast import cast_view
from train.synthetic.photography.renderer import render
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.sampling.measured_skins import MeasuredSkins
from train.synthetic.sampling.scene_sampling import sample_scene
from train.synthetic.scene import (
    CameraParameters,
    FaceParameters,
    HeadBuffers,
    LightParameters,
    SceneParameters,
    SurroundingsParameters,
    map_tensors,
)
from train.synthetic.subjects.framing import Framing, make_view
from train.synthetic.subjects.heads import make_ict_head, make_procedural_head

SUPERSAMPLING = 2
"""Pixels of the renderer along a side of a pixel of the portrait, for smooth edges."""

_OIL = 0.3
"""Factor on the oil of the sampled skin: studios powder the face."""

_LAMPS = ((-0.5, 0.45, 0.74), (0.7, 0.1, 0.7), (0.0, 0.0, 1.0))
_STRENGTHS, _SOFTNESS = (0.55, 0.12, 0.0), 0.5
_SKY = {0: 0.5, 1: 0.12}
_TINTS = ((-0.05, 0.0, 0.07), (0.03, 0.0, -0.05), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
"""Log factors on linear RGB of the sky, which is bluish, and of the lamps, one of them warm."""

_WALL = (0.30, 0.38, 0.46)


class Sitter(NamedTuple):
    """A person: the caption, the random numbers of head and face, and the yaw in radians."""

    name: str
    head: int
    face: int
    yaw: float


class Portrait(NamedTuple):
    """A rendered photograph and its truth.

    Attributes:
        photo: uint8 sRGB [size, size, 3].
        melanin: Mean fraction over the skin that is seen.
        hemoglobin: The same of blood.
    """

    photo: NDArray[np.uint8]
    melanin: float
    hemoglobin: float


def render_portrait(sitter: Sitter, size: int, ict: Path | None) -> Portrait:
    """Render the portrait of a person.

    Args:
        sitter: The person.
        size: Side of the portrait in pixels.
        ict: ICT-FaceKit as an .npz, whose faces look like people; None: a procedural head.

    Returns:
        The portrait.
    """
    scene = compose_portrait(sitter, SUPERSAMPLING * size, ict)
    batch = render(map_tensors(lambda value: value[None], scene), SkinDecoder(), "val")
    photo = to_uint8(batch.photograph[0].movedim(0, -1).numpy())
    assert batch.truth is not None
    skin = batch.mask > 0.5
    means = [float(one[skin].mean()) for one in (batch.truth.melanin, batch.truth.hemoglobin)]
    return Portrait(resize(photo, size, size), *means)


def compose_portrait(
    sitter: Sitter, size: int, ict: Path | None, expression: Mapping[str, float] | None = None
) -> SceneParameters:
    """Compose the portrait of a person.

    Args:
        sitter: The person.
        size: Side of the renderer's picture in pixels.
        ict: ICT-FaceKit as an .npz; None: a procedural head.
        expression: Weights of ICT-FaceKit's shapes; None: a mild one.
    """
    head = _cast_head(sitter, size, ict, expression)
    return _compose(head, _paint_face(sitter.face), sitter.head)


def _cast_head(
    sitter: Sitter, size: int, ict: Path | None, expression: Mapping[str, float] | None
) -> HeadBuffers:
    rng = np.random.default_rng([1, sitter.head])
    head: LabelledMesh = (
        make_procedural_head(rng)
        if ict is None
        else make_ict_head(_read_ict_model(ict), rng, expression=expression)
    )
    angles = np.array([0.03, sitter.yaw, 0.0])
    view = make_view(Framing(angles, 0.7, np.array([0.0, 0.02]), 9.0, False), np.zeros(3), size)
    return cast_view(head, Scene(Mesh(head.vertices, head.triangles)), view).to_buffers()


@cache
def _read_ict_model(path: Path) -> IctModel:
    return read_ict_model(path)


def _paint_face(seed: int) -> FaceParameters:
    """A face with the blood and the nuisance of a measured skin, and little shine."""
    face = map_tensors(torch.Tensor.float, sample_face(np.random.default_rng([3, seed])))
    face = MeasuredSkins().apply(face, np.random.default_rng([4, seed]))
    specular = face.skin.specular._replace(oil=_OIL * face.skin.specular.oil)
    return face._replace(skin=face.skin._replace(specular=specular))


def _compose(head: HeadBuffers, face: FaceParameters, seed: int) -> SceneParameters:
    """Place a head before an even wall, in the light and the camera of a studio."""
    scene = sample_scene(np.random.default_rng([2, seed]), head)
    surroundings, light = _make_wall(scene.surroundings), _light_softly(scene.light)
    return SceneParameters(head, face, surroundings, light, _steady_camera(scene.camera))


def _make_wall(sampled: SurroundingsParameters) -> SurroundingsParameters:
    plain = {
        name: torch.zeros_like(getattr(sampled, name))
        for name in ("coarse_clutter", "fine_clutter", "pattern", "tie")
    }
    wall = torch.tensor(_WALL)[:, None, None].expand_as(sampled.wall)
    return sampled._replace(wall=wall, wall_light=torch.tensor(1.0), **plain)


def _light_softly(sampled: LightParameters) -> LightParameters:
    sky, mixture = torch.zeros(9), torch.zeros_like(sampled.mixture)
    for term, value in _SKY.items():
        sky[term] = value
    mixture[0] = 1.0  # daylight alone
    return sampled._replace(
        sky=sky,
        lamps=torch.nn.functional.normalize(torch.tensor(_LAMPS), dim=1),
        strength=torch.tensor(_STRENGTHS),
        softness=torch.full((len(_LAMPS),), _SOFTNESS),
        mixture=mixture,
        temperature=torch.tensor(5500.0),
        tints=torch.tensor(_TINTS),
    )


def _steady_camera(sampled: CameraParameters) -> CameraParameters:
    return sampled._replace(
        white_balance=torch.zeros(2),
        exposure=torch.tensor(1.1),
        metering=torch.tensor(0.2),
        tone=torch.tensor([0.05, 0.05]),
        blur=torch.tensor(0.35),
        noise=torch.zeros(2),
        quality=torch.tensor(0.0),
        mirror=torch.tensor(0.0),
    )
