"""Buffers hold what rays hit, and shadows lie where geometry says."""

import numpy as np
import pytest
from trimesh.creation import box, icosphere

from skinnet.mesh._vectors import normalise
from skinnet.mesh.mesh import Mesh
from skinnet.render._view_axes import compute_view_axes
from skinnet.render.views import OrthographicView, PerspectiveView
from skinnet.render.visibility import trace_geometry


def square(half: float, z: float = 0.0) -> Mesh:
    """A square that faces +z, its texture coordinates from 0 to 1."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float64)
    vertices = np.column_stack([half * corners, np.full(4, z)])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    return Mesh(vertices, triangles, (corners + 1) / 2, triangles)


def join_meshes(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + s for m, s in zip(meshes, starts, strict=False)]),
    )


def from_above(size: int = 40, scale: float = 10.0) -> OrthographicView:
    return OrthographicView((size, size), np.array([0.0, 0, 10]), compute_view_axes(0.0), scale)


@pytest.mark.parametrize("far", [0.0, 1e4])
def test_buffers_hold_the_visible_surface(far: float) -> None:
    mesh = square(1.5)
    mesh = Mesh(mesh.vertices + [far, 0, 0], mesh.triangles, mesh.uv, mesh.uv_triangles)
    view = PerspectiveView((30, 30), np.array([far, 0, 2.9]), compute_view_axes(0.0), 30.0)
    buffers = trace_geometry(mesh, view, samples=2)
    assert buffers.hit.shape == (60, 60) and buffers.hit.all()
    row, column = np.nonzero(buffers.hit)
    projected = view.project(buffers.position)
    assert np.allclose(projected, (np.stack([column, row], 1) + 0.5) / 2, atol=1e-6)
    assert buffers.uv is not None
    assert np.allclose(buffers.uv, (buffers.position[:, :2] - [far, 0]) / 3 + 0.5)
    assert np.allclose(buffers.normal, [0, 0, 1]) and np.allclose(buffers.face_normal, [0, 0, 1])


def test_the_nearest_surface_hides_what_is_behind_it() -> None:
    mesh = join_meshes(square(0.5, z=1.0), square(1.5))
    buffers = trace_geometry(mesh, from_above())
    height = np.full(buffers.hit.shape, np.nan)
    height[buffers.hit] = buffers.position[:, 2]
    assert np.allclose(height[15:25, 15:25], 1) and np.allclose(height[6:14, 6:34], 0)
    assert np.isnan(height[:4]).all()


def test_normals_of_surfaces_seen_from_behind_face_the_viewer() -> None:
    mesh = square(1.5)
    reversed_ = Mesh(mesh.vertices, mesh.triangles[:, ::-1])
    buffers = trace_geometry(reversed_, from_above())
    assert np.allclose(buffers.normal, [0, 0, 1]) and (buffers.side == -1).all()
    assert (buffers.light_visibility(np.array([0.0, 0, 1])) == 1).all()


def test_a_sphere_shows_its_smooth_normals() -> None:
    ball = icosphere(subdivisions=4)
    buffers = trace_geometry(Mesh(np.array(ball.vertices), np.array(ball.faces)), from_above())
    assert np.abs(buffers.normal - normalise(buffers.position)).max() < 0.01


def test_a_box_casts_its_shadow_where_geometry_says() -> None:
    cube = box(extents=(1, 1, 1))
    cube.apply_translation([0, 0, 0.5])
    scene = join_meshes(square(3.0), Mesh(np.array(cube.vertices), np.array(cube.faces)))
    buffers = trace_geometry(scene, from_above(80, 13.3))
    light = normalise(np.array([1.0, 0.0, 1.0]))
    visibility = buffers.light_visibility(light)
    x, y, z = buffers.position.T
    # At 45 degrees a box of height one throws its shadow one unit to the other side.
    shadow = (x > -1.5) & (x < 0.5) & (np.abs(y) < 0.5)
    edge = (np.abs(np.abs(y) - 0.5) < 0.02) | (np.abs(x + 1.5) < 0.02) | (np.abs(x - 0.5) < 0.02)
    ground = (z < 1e-6) & ~edge
    assert np.array_equal(visibility[ground] == 0, shadow[ground]) and shadow[ground].sum() > 100


def test_a_wide_light_throws_a_soft_shadow() -> None:
    blocker, ground = square(1.0, z=1.0), square(4.0)
    view = OrthographicView((20, 60), np.array([3.0, 0.0, 0.5]), compute_view_axes(0.0), 10.0)
    buffers = trace_geometry(join_meshes(ground, blocker), view)
    hard = buffers.light_visibility(normalise(np.array([-1.0, 0, 1])))
    soft = buffers.light_visibility(normalise(np.array([-1.0, 0, 1])), angle=20.0, rays=64)
    x, y, _ = buffers.position.T
    # The blocker's edge at x = 1 throws to x = 2.
    assert (hard[x < 1.95] == 0).all() and (hard[x > 2.05] == 1).all()
    near, middle = np.abs(x - 2) < 0.06, np.abs(y) < 0.5
    assert 0.4 < soft[near & middle].mean() < 0.6
    # From 35 to 55 degrees: tan 35 = 0.7, tan 55 = 1.43.
    assert (soft[(x > 1.2) & (x < 1.68) & middle] == 0).all() and (soft[x > 2.45] == 1).all()


def test_no_triangle_shades_itself_or_its_neighbours_on_a_coarse_ball() -> None:
    ball = icosphere(subdivisions=1)
    buffers = trace_geometry(
        Mesh(np.array(ball.vertices), np.array(ball.faces)), from_above(60, 25.0)
    )
    light = normalise(np.array([1.0, 0.2, 0.3]))
    assert (buffers.light_visibility(light)[buffers.normal @ light > 0] == 1).all()
    assert (buffers.light_visibility(light)[buffers.normal @ light < 0] == 0).all()


def test_samples_interpolate_the_sky_visibility_of_their_side() -> None:
    ball = icosphere(subdivisions=2)
    vertices, triangles = np.array(ball.vertices), np.array(ball.faces)
    outside = trace_geometry(Mesh(vertices, triangles), from_above())
    inside = trace_geometry(Mesh(vertices, triangles[:, ::-1]), from_above())
    assert np.allclose(outside.sky_visibility(), 1)
    # The normals point inwards, and the viewer sees what they call the inside.
    assert np.allclose(inside.sky_visibility(), 1)
    within = PerspectiveView((8, 8), np.zeros(3), compute_view_axes(0.0), 4.0)
    assert np.allclose(trace_geometry(Mesh(vertices, triangles), within).sky_visibility(), 0)
