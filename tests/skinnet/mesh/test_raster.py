"""The raster: every texel in its triangle, no gaps, ties to the first."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from skinnet.mesh.raster import rasterise


def centres(size: int) -> np.ndarray:
    row, column = np.mgrid[:size, :size]
    return np.stack([(column + 0.5) / size, 1 - (row + 0.5) / size], -1)


def search_all(corners: np.ndarray, size: int) -> np.ndarray:
    """The first triangle that holds each texel's centre, by exhaustive search."""
    found = np.full((size, size), -1)
    for number in reversed(range(len(corners))):
        a, b, c = corners[number]
        matrix = np.stack([b - a, c - a], 1)
        if abs(np.linalg.det(matrix)) < 1e-15:
            continue
        second, third = np.moveaxis((centres(size) - a) @ np.linalg.inv(matrix).T, -1, 0)
        inside = (second >= -1e-12) & (third >= -1e-12) & (second + third <= 1 + 1e-12)
        found[inside] = number
    return found


@given(st.integers(0, 10**6), st.integers(1, 40))
def test_the_raster_agrees_with_an_exhaustive_search(seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    scale = 10 ** rng.uniform(-2, 0.5, (30, 1, 1))
    corners = rng.uniform(-0.3, 1.3, (30, 1, 2)) + scale * rng.normal(size=(30, 3, 2))
    raster = rasterise(corners, size)
    assert np.array_equal(raster.triangle, search_all(corners, size))


@given(st.integers(0, 10**6))
def test_barycentric_coordinates_give_back_the_centre(seed: int) -> None:
    points = np.random.default_rng(seed).uniform(0, 1, (40, 2))
    corners = points[Delaunay(points).simplices]
    triangle, barycentric = rasterise(corners, 64)
    inside = triangle >= 0
    place = np.einsum("tk,tkx->tx", barycentric[inside], corners[triangle[inside]])
    assert np.allclose(place, centres(64)[inside], atol=1e-9)
    assert barycentric.min() >= 0 and np.allclose(barycentric[inside].sum(1), 1)
    assert (barycentric[~inside] == 0).all()


@pytest.mark.parametrize("cells", [1, 3, 8, 16])
def test_neighbours_leave_no_gap_where_edges_run_through_centres(cells: int) -> None:
    # Cells of a whole number of texels, shifted by half of one: every edge holds centres.
    places = (np.arange(cells + 1) * 16 / cells + 0.5) / 16
    x, y = np.meshgrid(places, places)
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    corners = np.stack([x.ravel(), y.ravel()], 1)[triangles]
    triangle = rasterise(corners, 16).triangle
    assert (triangle >= 0).all()
    assert np.array_equal(triangle, search_all(corners, 16))
    again = rasterise(np.roll(corners, 1, 1)[:, ::-1], 16).triangle
    assert np.array_equal(again, triangle)


def test_row_zero_is_the_top_and_orientation_does_not_matter() -> None:
    corner = np.array([[[0.0, 1.0], [0.0, 0.6], [0.4, 1.0]]])
    for corners in (corner, corner[:, ::-1]):
        triangle = rasterise(corners, 10).triangle
        assert triangle[0, 0] == 0 and triangle[0, 9] == triangle[9, 0] == -1


def test_empty_and_outside_triangles_hold_nothing() -> None:
    point, line = np.full((3, 2), 0.5), np.array([[0.1, 0.1], [0.5, 0.5], [0.9, 0.9]])
    outside = np.array([[2.0, 2.0], [3.0, 2.0], [2.0, 3.0]])
    assert (rasterise(np.stack([point, line, outside]), 9).triangle == -1).all()
    assert rasterise(np.zeros((0, 3, 2)), 4).triangle.shape == (4, 4)


def test_overlapping_triangles_go_to_the_first() -> None:
    big = np.array([[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]])
    assert (rasterise(np.stack([big, big]), 5).triangle == 0).all()
