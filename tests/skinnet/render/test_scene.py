"""Scenes: rays hit what they should, and sky visibility is the share of the sky."""

import numpy as np
import pytest
from trimesh.creation import icosphere

from skinnet.errors import InputError
from skinnet.mesh import Mesh
from skinnet.mesh._vectors import normalise
from skinnet.render import Scene

_SPHERE = icosphere(subdivisions=2)
BALL = Mesh(np.array(_SPHERE.vertices), np.array(_SPHERE.faces), name="ball")


@pytest.mark.parametrize("far", [0.0, 1e5])
def test_rays_hit_the_nearest_triangle_in_double_precision(far: float) -> None:
    mesh = Mesh(BALL.vertices + far, BALL.triangles)
    rng = np.random.default_rng(0)
    target = 0.5 * normalise(rng.normal(size=(200, 3))) + far
    origins = 5 * normalise(rng.normal(size=(200, 3))) + far
    triangle, barycentric = Scene(mesh).intersect(origins, target - origins)
    assert (triangle >= 0).all() and np.allclose(barycentric.sum(1), 1)
    place = np.einsum("pk,pkx->px", barycentric, mesh.vertices[mesh.triangles[triangle]])
    along = normalise(target - origins)
    assert np.abs(np.cross(place - origins, along)).max() < 1e-9 * max(far, 1)
    # The near side of the ball: between the origin and the target.
    distance = np.einsum("px,px->p", place - origins, along)
    assert (distance > 0).all() and (distance < np.linalg.norm(target - origins, axis=1)).all()


def test_a_ray_that_hits_nothing_has_no_triangle() -> None:
    triangle, barycentric = Scene(BALL).intersect(np.full((1, 3), 9.0), np.ones((1, 3)))
    assert triangle.tolist() == [-1] and not barycentric.any()


def test_occluded_rays_are_those_that_hit() -> None:
    scene = Scene(BALL)
    starts = scene.to_local(np.array([[0.0, 0, 0], [0, 0, 5], [0, 0, -5]]))
    assert scene.occluded(starts, np.array([[0.0, 0, 1]])).tolist() == [True, False, True]


def test_sky_visibility_is_the_share_of_the_sky_that_nothing_hides() -> None:
    scene = Scene(BALL)
    assert (scene.outer_sky_visibility == 1).all()
    assert (scene.inner_sky_visibility == 0).all()
    # A wall that rises for ever from the edge of a floor hides half of the floor's sky.
    wall = np.array([[0, -99, 0], [0, 99, 0], [0, 99, 99], [0, -99, 99]], np.float64)
    floor = np.array([[0.5, 0, 0], [1.5, 0, 0], [0.5, 1, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6]])
    scene = Scene(Mesh(np.concatenate([wall, floor]), triangles))
    assert scene.outer_sky_visibility[4:] == pytest.approx([0.5] * 3, abs=0.04)


@pytest.mark.parametrize(
    "mesh",
    [
        Mesh(np.eye(3), np.zeros((0, 3), np.int64), name="hat"),
        Mesh(np.full((3, 3), np.nan), np.array([[0, 1, 2]]), name="hat"),
    ],
)
def test_a_mesh_that_no_ray_can_hit_is_refused(mesh: Mesh) -> None:
    with pytest.raises(InputError, match="hat"):
        Scene(mesh)
