"""Rays hit the same triangles with Embree and without it."""

import sys
from pathlib import Path

import numpy as np
import pytest
from trimesh.creation import icosphere

from skinnet.mesh import Mesh
from skinnet.render import DirectionalLight, Scene, frame_face, render, trace_geometry
from skinnet.render._ray_caster import make_caster
from skinnet.render._triangle_tree import TriangleTree

RNG = np.random.default_rng(0)


def make_bumpy_ball(subdivisions: int = 3) -> Mesh:
    ball = icosphere(subdivisions=subdivisions)
    vertices = np.array(ball.vertices)
    bumps = 1 + 0.3 * np.sin(9 * vertices).prod(1, keepdims=True)
    return Mesh(vertices * bumps, np.array(ball.faces), name="ball")


def without_embree(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> Scene:
    with monkeypatch.context() as patched:
        patched.setitem(sys.modules, "embreex", None)
        return Scene(mesh)


@pytest.fixture
def scenes(monkeypatch: pytest.MonkeyPatch) -> tuple[Scene, Scene]:
    pytest.importorskip("embreex", reason="There is no wheel of it for this platform.")
    mesh = make_bumpy_ball()
    found = Scene(mesh), without_embree(mesh, monkeypatch)
    assert [type(scene._caster).__name__ for scene in found] == ["_Embree", "_Boxes"]
    return found


def test_random_rays_hit_the_same_triangles(scenes: tuple[Scene, Scene]) -> None:
    origins = RNG.normal(size=(4000, 3))
    directions = RNG.normal(size=(4000, 3))
    (first, places), (other, others) = (one.intersect(origins, directions) for one in scenes)
    same = first == other
    # The rest pass between two triangles, and either is right.
    assert same.mean() > 0.999 and ((first < 0) == (other < 0)).all()
    assert np.array_equal(places[same], others[same])
    starts = scenes[0].to_local(origins)
    blocked = [scene.occluded(starts, directions) for scene in scenes]
    assert np.array_equal(*blocked) and 0.2 < blocked[0].mean() < 0.8


def test_visibility_and_pictures_are_the_same(scenes: tuple[Scene, Scene]) -> None:
    for name in ("outer_sky_visibility", "inner_sky_visibility"):
        first, other = (getattr(scene, name) for scene in scenes)
        assert np.abs(first - other).max() <= 2 / 128, name
    view = frame_face(scenes[0].mesh.vertices, (24, 24))
    light = DirectionalLight(np.array([1.0, 1.0, 1.0]), angle=5.0)
    buffers = [trace_geometry(scene, view, 2) for scene in scenes]
    assert np.array_equal(buffers[0].hit, buffers[1].hit)
    visible = [one.light_visibility(light.direction, light.angle) for one in buffers]
    assert np.abs(visible[0] - visible[1]).mean() < 1e-3
    pictures = [render(scene, np.full(3, 0.5), [light], view) for scene in scenes]
    assert np.abs(pictures[0] - pictures[1]).mean() < 1e-3


def test_no_ray_passes_between_triangles() -> None:
    """A square of many triangles, hit exactly on its edges and corners."""
    steps = np.arange(9.0)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps, indexing="ij"))
    vertices = np.stack([x, y, 0 * x], 1)
    corner = (9 * np.arange(8)[:, None] + np.arange(8)).ravel()
    triangles = np.concatenate(
        [
            np.stack([corner, corner + 9, corner + 10], 1),
            np.stack([corner, corner + 10, corner + 1], 1),
        ]
    )
    tree = TriangleTree(vertices[triangles])
    targets = np.concatenate(
        [vertices, vertices[triangles].mean(1), (vertices[triangles].mean(1) + 0.5) % 8]
    )
    for towards in ([0.0, 0.0, -1.0], [1e-3, 2e-3, -1.0], [0.0, 0.0, 1.0]):
        direction = np.tile(towards, (len(targets), 1))
        found = tree.find_first(targets - 3 * direction, direction)
        assert (found >= 0).all()
        assert (tree.find_first(targets - 3 * direction, -direction) == -1).all()


def test_the_nearest_of_parallel_squares_is_hit_from_either_side() -> None:
    square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0]])
    corners = np.stack([square + [0, 0, height] for height in range(20)])
    tree = TriangleTree(corners)
    origins = np.array([[0.3, -0.2, 99], [0.3, -0.2, -9], [0.3, -0.2, 4.5], [0.3, -0.2, 4.5]])
    directions = np.array([[0.0, 0, -2], [0, 0, 1], [0, 0, 1], [0, 0, -1]])
    assert tree.find_first(origins, directions).tolist() == [19, 0, 5, 4]


@pytest.mark.parametrize("count", [1, 7, 8, 9, 65])
def test_meshes_of_any_size(count: int) -> None:
    corners = RNG.normal(size=(count, 3, 3))
    targets = corners.mean(1)
    origins = targets + np.array([0.0, 0.0, 1e-3])
    found = TriangleTree(corners).find_first(origins, targets - origins)
    assert np.array_equal(found, np.arange(count))
    assert TriangleTree(corners).find_first(np.zeros((0, 3)), np.zeros((0, 3))).shape == (0,)


def test_flat_and_double_triangles_do_no_harm() -> None:
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [1, 0, 0], [2, 0, 0]]])
    corners = np.concatenate([corners, corners, np.zeros((1, 3, 3))])
    found = TriangleTree(corners).find_first(np.array([[0.2, 0.2, 1.0]]), np.array([[0.0, 0, -1]]))
    assert found.tolist() == [0]
    same = TriangleTree(np.ones((9, 3, 3))).find_first(np.zeros((1, 3)), np.ones((1, 3)))
    assert same.tolist() == [-1]


def test_the_caster_of_a_broken_installation_is_the_slower_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("embreex", "embreex.mesh_construction", "embreex.rtcore_scene"):
        monkeypatch.setitem(sys.modules, name, None)
    vertices = np.eye(3, dtype=np.float32)
    caster = make_caster(vertices, np.array([[0, 1, 2]]))
    start = np.zeros((2, 3), np.float32)
    assert caster.find_first(start, np.array([[1.0, 1, 1], [-1, 1, 1]])).tolist() == [0, -1]
    assert caster.is_blocked(start, np.array([[1.0, 1, 1]])).tolist() == [True, True]
