"""The chart of the face goes with the landmarks, from pixels and back."""

import numpy as np
import pytest
from skimage.data import astronaut

from skinnet.images import Face, find_faces
from skinnet.images.faces._face_chart import (
    extend_landmarks,
    locate_on_chart,
    normalise_landmarks,
    place_texels,
)


@pytest.fixture(scope="module")
def face() -> Face:
    return find_faces(astronaut())[0]


def test_a_face_lies_upright_within_its_chart(face: Face) -> None:
    chart = normalise_landmarks(face.landmarks)
    rim = extend_landmarks(chart)
    assert rim.shape == (504, 2) and np.abs(rim - 0.5).max() < 0.6
    assert abs(chart[33, 1] - chart[263, 1]) < 0.02


@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi])
def test_a_chart_does_not_know_tilt_and_size(face: Face, angle: float) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = 0.5 * face.landmarks @ turn.T + (700, 600)
    assert np.allclose(normalise_landmarks(turned), normalise_landmarks(face.landmarks), atol=1e-4)


def test_landmarks_are_found_at_their_places(face: Face) -> None:
    chart = normalise_landmarks(face.landmarks)
    places, weight = locate_on_chart(face.landmarks, chart, (512, 512))
    for number in (4, 50, 280, 151, 199):
        column, row = face.landmarks[number].astype(int)
        assert np.abs(places[row, column] - chart[number]).max() < 0.01
        assert weight[row, column] == 1
    assert weight[0, 0] == weight[500, 20] == 0
    steps = np.abs(np.diff(weight, axis=0)).max(), np.abs(np.diff(weight, axis=1)).max()
    assert max(steps) < 0.15


def test_texels_and_pixels_are_inverse(face: Face) -> None:
    chart = normalise_landmarks(face.landmarks)
    texels = place_texels(face.landmarks, chart, 64)
    places, _ = locate_on_chart(face.landmarks, chart, (512, 512))
    for row, column in ((32, 32), (40, 24), (22, 36)):
        x, y = texels[row, column].astype(int)
        assert np.abs(64 * places[y, x] - (column + 0.5, row + 0.5)).max() < 0.8
    assert np.isnan(texels[0, 0]).all()
