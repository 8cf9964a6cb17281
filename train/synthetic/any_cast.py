"""Casts of the variety `any`: one person, a group, or skin without a face."""

import numpy as np

from skinnet.mesh import Mesh
from skinnet.render import OrthographicView, PerspectiveView, Scene
from train.synthetic.bare_skin import make_skin_scene
from train.synthetic.framing import make_view, sample_framing, sample_kind
from train.synthetic.head_cast import HeadCast, cast_view
from train.synthetic.labelled_mesh import LabelledMesh
from train.synthetic.labels import BODY, MATERIALS
from train.synthetic.people import MakeHead, make_group, make_person, sample_group


def cast_any(make_head: MakeHead, rng: np.random.Generator, size: int) -> HeadCast:
    """Cast a picture of a random kind.

    Args:
        make_head: Makes a head with its bust.
        rng: Random numbers.
        size: Side of the picture in pixels.

    Returns:
        Its buffers.
    """
    kind, origin = sample_kind(rng), np.zeros(3)
    if kind == "face":
        framing = sample_framing(rng)
        return _cast(make_person(make_head(rng), rng), make_view(framing, origin, size))
    if kind == "group":
        placements, framing = sample_group(rng)
        group = make_group(placements, make_head, rng)
        return _cast(group, make_view(framing, origin, size))
    mesh, point, framing = make_skin_scene(make_head, rng)
    return _paint_once(_cast(mesh, make_view(framing, point, size)))


def _cast(mesh: LabelledMesh, view: OrthographicView | PerspectiveView) -> HeadCast:
    scene = Scene(Mesh(mesh.vertices, mesh.triangles, name="a synthetic scene"))
    return cast_view(mesh, scene, view)


def _paint_once(cast: HeadCast) -> HeadCast:
    """Let a limb's wall and sleeves be of its own painting, so that there is no other."""
    if not (cast.label >= BODY * MATERIALS).any():
        return cast
    cast.label[:] = cast.label % MATERIALS + BODY * MATERIALS
    return cast
