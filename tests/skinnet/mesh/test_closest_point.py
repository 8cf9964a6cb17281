"""Closest points are exact, whatever the triangles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from trimesh.triangles import closest_point

from skinnet.mesh.closest_point import TriangleTree


def search_all(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    pairs = np.repeat(corners, len(points), 0), np.tile(points, (len(corners), 1))
    away = np.linalg.norm(closest_point(*pairs) - pairs[1], axis=1)
    return away.reshape(len(corners), -1).min(0)


@given(st.integers(0, 10**6), st.sampled_from([1, 3, 4, 5, 40, 130]))
def test_closest_points_agree_with_an_exhaustive_search(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    # Triangles from a thousandth to ten, long ones and some that are points or lines.
    vertices = rng.normal(size=(60, 3)) * 10 ** rng.uniform(-3, 1, (60, 1))
    triangles = rng.integers(0, 60, (count, 3))
    points = 3 * rng.normal(size=(50, 3))
    found = TriangleTree(vertices, triangles).query(points)
    corners = vertices[triangles]
    solid = (np.roll(triangles, 1, 1) != triangles).all(1)
    if solid.all():
        assert np.allclose(found.distance, search_all(corners, points), atol=1e-9)
    place = np.einsum("pk,pkx->px", found.barycentric, corners[found.triangle])
    assert np.allclose(np.linalg.norm(place - points, axis=1), found.distance, atol=1e-9)
    assert found.barycentric.min() >= 0 and np.allclose(found.barycentric.sum(1), 1)


def test_a_limit_leaves_out_what_is_farther() -> None:
    vertices, triangles = np.eye(3), np.array([[0, 1, 2]])
    points = np.array([[0.0, 0.0, 0.0], [5.0, 5.0, 5.0], [1.0, 0.0, 0.0]])
    found = TriangleTree(vertices, triangles).query(points, limit=1.0)
    assert found.triangle.tolist() == [0, -1, 0]
    assert found.distance.tolist() == pytest.approx([3**-0.5, np.inf, 0.0])
    assert (found.barycentric[1] == 0).all()


def test_no_queries_have_no_answers() -> None:
    found = TriangleTree(np.eye(3), np.array([[0, 1, 2]])).query(np.zeros((0, 3)))
    assert found.distance.shape == (0,) and found.barycentric.shape == (0, 3)
