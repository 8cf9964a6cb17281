"""Rendered pictures: sRGB over a background."""

import numpy as np
from trimesh.creation import icosphere

from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh import Mesh
from skinnet.render import (
    DirectionalLight,
    OrthographicView,
    SphericalHarmonics,
    frame_face,
    render,
)

_SPHERE = icosphere(subdivisions=4)
BALL = Mesh(np.array(_SPHERE.vertices), np.array(_SPHERE.faces), name="ball")


def even(radiance: float) -> SphericalHarmonics:
    return SphericalHarmonics(np.r_[radiance * np.sqrt(4 * np.pi), np.zeros(8)])


def test_render_is_srgb_over_a_background() -> None:
    view = frame_face(BALL.vertices, (24, 32))
    picture = render(BALL, np.full(3, 0.5), [even(0.6)], view, background=(0.0, 0.2, 1.0))
    assert picture.dtype == np.uint8 and picture.shape == (24, 32, 3)
    assert (picture[12, 16] == to_uint8(linear_to_srgb(np.array([0.3])))).all()
    assert picture[0, 0].tolist() == to_uint8(linear_to_srgb(np.array([0.0, 0.2, 1.0]))).tolist()
    clipped = render(BALL, np.ones(3), [even(7.0)], view, samples=1)
    assert (clipped == 255).all()


def test_an_empty_picture_is_its_background() -> None:
    view = OrthographicView((5, 5), np.array([99.0, 0, 10]), np.eye(3), 1.0)
    lamps = [DirectionalLight((0.0, 0.0, 1.0), angle=3.0), even(1.0)]
    assert (render(BALL, np.ones(3), lamps, view) == 255).all()
