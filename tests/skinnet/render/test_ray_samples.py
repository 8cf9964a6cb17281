"""Directions that rays are cast in."""

import numpy as np

from skinnet.mesh._vectors import normalise
from skinnet.render._ray_samples import build_tangents, rotate, sample_disc


def test_tangents_and_normal_are_orthonormal() -> None:
    normals = normalise(np.random.default_rng(0).normal(size=(100, 3)))
    normals = np.concatenate([normals, np.eye(3), -np.eye(3)])
    frame = np.stack([*build_tangents(normals), normals], 1)
    assert np.allclose(frame @ np.swapaxes(frame, 1, 2), np.eye(3))
    assert np.allclose(np.linalg.det(frame), 1)


def test_a_point_is_rotated_about_the_origin() -> None:
    x, y = rotate(1.0, 0.0, np.array([[0.0], [np.pi / 2]]))
    assert np.allclose(np.hstack([x, y]), [[1, 0], [0, 1]])


def test_the_disc_is_evenly_covered() -> None:
    points = sample_disc(2000)
    radius = np.linalg.norm(points, axis=1)
    assert radius.max() < 1 and np.allclose(points.mean(0), 0, atol=1e-3)
    # Half of a disc's area lies within 1 / sqrt(2).
    assert np.isclose((radius < 0.5**0.5).mean(), 0.5, atol=1e-3)
