"""Casts of the variety `any`: one person, a group, or skin without a face."""

import numpy as np

from skinnet.mesh import Mesh
from skinnet.render import OrthographicView, PerspectiveView, Scene
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.casts.head_cast import HeadCast, cast_view
from train.synthetic.labels import BODY, EYE, FILM, MATERIALS, MOUTH, SKIN, TEETH
from train.synthetic.subjects.bare_skin import Shot, make_skin_scene
from train.synthetic.subjects.framing import Kind, make_view, sample_framing, sample_kind
from train.synthetic.subjects.people import MakeHead, make_group, make_person, sample_group

_TRIES = 20
_LEAST_SKIN, _LEAST_LIMB, _LEAST_CLOSE_UP = 0.004, 0.06, 0.5
"""Least shares of skin in pictures with a face, of limbs and of cheeks; less is sampled again."""


def cast_any(make_head: MakeHead, rng: np.random.Generator, size: int) -> HeadCast:
    """Cast a picture of a random kind.

    Args:
        make_head: Makes a head with its bust.
        rng: Random numbers.
        size: Side of the picture in pixels.

    Returns:
        Its buffers.
    """
    kind = sample_kind(rng)
    for _ in range(_TRIES):
        mesh, point, framing = _SAMPLERS[kind](make_head, rng)
        cast = _cast(mesh, make_view(framing, point, size))
        if _shows_skin(cast, kind):
            break
    return _paint_once(cast) if kind == "skin" else cast


def _sample_face(make_head: MakeHead, rng: np.random.Generator) -> Shot:
    framing = sample_framing(rng)
    return Shot(make_person(make_head(rng), rng), np.zeros(3), framing)


def _sample_group(make_head: MakeHead, rng: np.random.Generator) -> Shot:
    placements, framing = sample_group(rng)
    return Shot(make_group(placements, make_head, rng), np.zeros(3), framing)


_SAMPLERS = {"face": _sample_face, "group": _sample_group, "skin": make_skin_scene}


def _shows_skin(cast: HeadCast, kind: Kind) -> bool:
    """Whether enough skin is seen, and of pictures of skin no eye or mouth."""
    material = cast.label % FILM
    if kind != "skin":
        return bool((material == SKIN).mean() > _LEAST_SKIN)
    least = _LEAST_LIMB if (cast.label >= BODY * MATERIALS).any() else _LEAST_CLOSE_UP
    features = np.isin(material, (EYE, TEETH, MOUTH)).any()
    return bool((material == SKIN).mean() > least and not features)


def _cast(mesh: LabelledMesh, view: OrthographicView | PerspectiveView) -> HeadCast:
    scene = Scene(Mesh(mesh.vertices, mesh.triangles, name="a synthetic scene"))
    return cast_view(mesh, scene, view)


def _paint_once(cast: HeadCast) -> HeadCast:
    """Let a limb's wall and sleeves be of its own painting, so that there is no other."""
    if not (cast.label >= BODY * MATERIALS).any():
        return cast
    cast.label[:] = cast.label % MATERIALS + BODY * MATERIALS
    return cast
