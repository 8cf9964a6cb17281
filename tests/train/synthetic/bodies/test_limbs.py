"""Tubes are closed, and arms reach where they should."""

import numpy as np
import pytest

from train.synthetic.bodies.limbs import Tube, bend_line, find_elbow, make_tube


@pytest.fixture
def tube() -> Tube:
    count = 30
    line = np.stack([np.zeros(count), np.linspace(0, 3, count), np.zeros(count)], 1)
    back = np.tile([0.0, 0, 1], (count, 1))
    return Tube(line, back, np.full(count, 0.4), np.full(count, 0.3), np.linspace(-1, 1, count))


def test_a_tube_faces_outwards_and_has_the_volume_of_its_sections(tube: Tube) -> None:
    mesh = make_tube(tube, 1)
    corners = mesh.vertices[mesh.triangles]
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    # An elliptic cylinder between two half ellipsoids, drawn with 28 sides.
    expected = np.pi * 0.4 * 0.3 * 3 + 4 / 3 * np.pi * 0.4 * 0.3 * 0.3
    assert volume == pytest.approx(expected, rel=0.03)


def test_the_back_of_a_tube_is_the_middle_of_its_chart(tube: Tube) -> None:
    mesh = make_tube(tube, 1)
    back = np.abs(mesh.chart[:, 0]) < 1e-6
    assert (mesh.vertices[back, 2] > 0).all()
    assert np.abs(mesh.chart[:, 0]).max() == pytest.approx(2)


def test_a_bent_line_keeps_its_ends_and_rounds_its_corner() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    line = bend_line(corners, 41, 0.3)
    np.testing.assert_allclose(line[[0, -1]], corners[[0, -1]])
    gap = np.linalg.norm(line - corners[1], axis=1).min()
    assert 0.03 < gap < 0.3


def test_an_elbow_is_as_far_from_shoulder_and_wrist_as_the_arm_is_long() -> None:
    shoulder, wrist = np.array([1.0, 2, 0]), np.array([0.0, 0.5, 1.5])
    elbow = find_elbow(shoulder, wrist, (2.6, 2.2), np.array([1.0, -1, 0]))
    assert np.linalg.norm(elbow - shoulder) == pytest.approx(2.6)
    assert np.linalg.norm(elbow - wrist) == pytest.approx(2.2)


def test_an_arm_that_is_too_short_is_stretched() -> None:
    wrist = np.array([0.0, 10, 0])
    elbow = find_elbow(np.zeros(3), wrist, (2.6, 2.2), np.array([1.0, 0, 0]))
    assert np.isfinite(elbow).all()
    assert np.linalg.norm(elbow) + np.linalg.norm(elbow - wrist) == pytest.approx(10, rel=0.02)
