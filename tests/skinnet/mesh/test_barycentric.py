"""Gradients of barycentric coordinates, and interpolation."""

import numpy as np

from skinnet.mesh._barycentric import compute_barycentric_gradients, interpolate


def test_a_step_to_a_corner_changes_its_coordinate_by_one() -> None:
    places = np.random.default_rng(0).normal(size=(20, 3, 2))
    gradients = compute_barycentric_gradients(places)
    for start in range(3):
        for end in range(3):
            step = places[:, end] - places[:, start]
            change = np.einsum("tkx,tx->tk", gradients, step)
            assert np.allclose(change, np.eye(3)[end] - np.eye(3)[start])


def test_a_triangle_without_an_area_has_no_gradients() -> None:
    line = np.array([[[0.0, 0], [1, 1], [2, 2]], [[3, 3], [3, 3], [3, 3]]])
    assert np.isnan(compute_barycentric_gradients(line)).all()


def test_values_are_interpolated_between_corners() -> None:
    corners = np.array([[[1.0, 0], [2, 0], [4, 8]]])
    assert np.allclose(interpolate(np.array([[0.5, 0.25, 0.25]]), corners), [[2, 2]])
