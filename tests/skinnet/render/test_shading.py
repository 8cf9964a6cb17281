"""Shading: energy in is energy out, albedo where it belongs, smooth edges."""

import numpy as np
import pytest
from trimesh.creation import icosphere

from skinnet.errors import InputError
from skinnet.mesh._vectors import normalise
from skinnet.mesh.mesh import Mesh
from skinnet.render._shading import EXPONENT, shade
from skinnet.render._view_axes import compute_view_axes
from skinnet.render.lights import DirectionalLight, SphericalHarmonics
from skinnet.render.views import OrthographicView
from skinnet.render.visibility import trace_geometry

_SPHERE = icosphere(subdivisions=4)
BALL = Mesh(np.array(_SPHERE.vertices), np.array(_SPHERE.faces), name="ball")
WHITE = np.ones(3)


def even(radiance: float) -> SphericalHarmonics:
    return SphericalHarmonics(np.r_[radiance * np.sqrt(4 * np.pi), np.zeros(8)])


def plane() -> Mesh:
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float64)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    vertices = np.column_stack([corners, np.zeros(4)])
    return Mesh(vertices, triangles, (corners + 1) / 2, triangles, name="plane")


def above(size: int, scale: float) -> OrthographicView:
    return OrthographicView((size, size), np.array([0.0, 0, 10]), compute_view_axes(0.0), scale)


def test_a_ball_in_even_light_of_radiance_l_sends_out_albedo_times_l() -> None:
    buffers = trace_geometry(BALL, above(40, 15.0))
    image, alpha = shade(buffers, np.array([0.2, 0.5, 1.0]), [even(0.6)])
    assert np.allclose(image[alpha == 1], 0.6 * np.array([0.2, 0.5, 1.0]))
    assert (image[alpha == 0] == 0).all()


@pytest.mark.parametrize("shadows", [True, False])
def test_a_ball_under_one_light_is_n_dot_l(shadows: bool) -> None:
    buffers = trace_geometry(BALL, above(60, 28.0))
    direction = normalise(np.array([0.5, 0.4, 0.8]))
    lamp = DirectionalLight(5 * direction, (0.9, 0.6, 0.3))
    image, _ = shade(buffers, WHITE, [lamp], shadows)
    cosine = (normalise(buffers.position) @ direction).clip(0)
    found = image[buffers.hit]
    assert np.abs(found - cosine[:, None] * [0.9, 0.6, 0.3]).max() < 0.01


def test_lights_add_up() -> None:
    buffers = trace_geometry(BALL, above(20, 8.0))
    lamps = [
        DirectionalLight((1.0, 0.0, 1.0), 0.5),
        DirectionalLight((-1.0, 0.0, 1.0), 0.2, angle=5.0),
        even(0.1),
    ]
    both = shade(buffers, WHITE, lamps).image
    assert np.allclose(both, sum(shade(buffers, WHITE, [lamp]).image for lamp in lamps))


def test_a_texel_appears_where_it_lies() -> None:
    albedo = np.random.default_rng(0).random((8, 8, 3))
    buffers = trace_geometry(plane(), above(8, 4.0))
    image, alpha = shade(buffers, albedo, [even(1.0)])
    assert (alpha == 1).all() and np.allclose(image, albedo, atol=1e-6)


def test_a_highlight_stands_halfway_and_is_of_its_strength() -> None:
    buffers = trace_geometry(BALL, above(101, 49.0))
    light = normalise(np.array([1.0, 0, 1.0]))
    lamp = DirectionalLight(light)
    dull = shade(buffers, WHITE, [lamp]).image
    glossy = shade(buffers, WHITE, [lamp], specular=0.04).image
    gloss = (glossy - dull)[..., 0]
    peak = 0.04 * (EXPONENT + 8) / 8 * np.cos(np.pi / 8)
    assert gloss.max() == pytest.approx(peak, rel=0.02)
    row, column = np.unravel_index(gloss.argmax(), gloss.shape)
    # A little towards the light of the halfway normal, since n . l weighs it.
    assert row == 50 and np.sin(np.pi / 8) * 49 <= column - 50 < np.sin(np.pi / 8) * 49 + 4
    even_light = [shade(buffers, WHITE, [even(1.0)], specular=k).image for k in (0.0, 0.04)]
    assert np.array_equal(*even_light)


def test_samples_are_averaged_in_linear_light() -> None:
    view = OrthographicView((4, 4), np.array([0.25, 0.25, 10.0]), compute_view_axes(0.0), 2.0)
    shaded = shade(trace_geometry(plane(), view, samples=4), WHITE, [even(0.5)])
    # The square ends at x = 1, a quarter of the way through a pixel of half a unit.
    assert shaded.alpha[2].tolist() == [1, 1, 1, 0.5] or shaded.alpha[2, 3] == pytest.approx(0.5)
    assert np.allclose(shaded.image, 0.5 * shaded.alpha[..., None])


def test_a_texture_needs_texture_coordinates() -> None:
    buffers = trace_geometry(BALL, above(10, 4.0))
    with pytest.raises(InputError, match="ball has no texture coordinates"):
        shade(buffers, np.ones((4, 4, 3)), [even(1.0)])


@pytest.mark.parametrize("direction", [(0.0, 0.0, 0.0), (np.nan, 0.0, 1.0)])
def test_a_light_from_nowhere_is_refused(direction: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="direction"):
        shade(trace_geometry(BALL, above(10, 4.0)), WHITE, [DirectionalLight(direction)])
