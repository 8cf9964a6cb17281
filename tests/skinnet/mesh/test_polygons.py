"""Polygons cut into triangles."""

import numpy as np

from skinnet.mesh._polygons import cut_polygons


def test_triangles_follow_the_order_of_the_polygons() -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = np.concatenate([square[:3], square, square[:2], square[1:]])
    triangles, owner = cut_polygons(corners, np.array([3, 4, 2, 3]))
    assert triangles.tolist() == [[0, 1, 2], [3, 4, 5], [3, 5, 6], [9, 10, 11]]
    assert owner.tolist() == [0, 1, 1, 3]


def test_a_polygon_without_an_area_or_that_crosses_itself_keeps_its_number_of_triangles() -> None:
    bow_tie = np.array([[0.0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 1, 0]])
    for corners in (np.zeros((5, 3)), bow_tie, np.full((6, 3), np.nan)):
        triangles, _ = cut_polygons(corners, np.array([len(corners)]))
        assert triangles.shape == (len(corners) - 2, 3)
