"""Normals: of length one, weighted by area, the same on both sides of a seam."""

import numpy as np
from trimesh.creation import box, icosphere

from skinnet.mesh._normals import compute_vertex_normals
from skinnet.mesh._topology import weld
from skinnet.mesh._vectors import normalise


def test_a_sphere_s_normals_point_outwards() -> None:
    ball = icosphere(subdivisions=3)
    normals = compute_vertex_normals(ball.vertices, ball.faces)
    assert np.abs(normals - normalise(ball.vertices)).max() < 0.02


def test_a_box_s_corner_faces_along_its_diagonal_however_it_is_split() -> None:
    cube = box()
    # Every triangle with corners of its own: only the positions tell that they meet.
    vertices = cube.vertices[cube.faces].reshape(-1, 3)
    triangles = np.arange(len(vertices)).reshape(-1, 3)
    normals = compute_vertex_normals(vertices, triangles)
    first = weld(vertices)
    assert np.array_equal(normals, normals[first]) and len(np.unique(first)) == 8
    assert (np.einsum("vx,vx->v", normals, normalise(vertices)) > 0.9).all()


def test_a_triangle_counts_by_its_area() -> None:
    vertices = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 1.0]])
    flat, wall = np.array([0, 1, 2]), np.array([0, 2, 3])
    normals = compute_vertex_normals(vertices, np.stack([flat, wall]))
    assert np.allclose(normals[0], normalise(np.array([3.0, 0, 9])))
    assert np.allclose(normals[1], [0, 0, 1])


def test_a_vertex_without_a_triangle_has_none() -> None:
    vertices = np.concatenate([np.eye(3), [[5.0, 5, 5]]])
    assert (compute_vertex_normals(vertices, np.array([[0, 1, 2]]))[3] == 0).all()
