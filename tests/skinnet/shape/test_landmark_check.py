"""Landmarks that cannot start a fit are refused in words."""

import numpy as np
import pytest
from small_meshes import LANDMARKS, dome, small_model

from skinnet.errors import InputError
from skinnet.shape._landmark_check import check_landmarks


def points() -> dict[str, np.ndarray]:
    return {name: dome().vertices[vertex] for name, vertex in LANDMARKS.items()}


def test_sound_landmarks_are_those_in_common() -> None:
    given = points() | {"scar": np.zeros(3)}
    given.pop("chin")
    assert check_landmarks(given, small_model(), dome()) == list(LANDMARKS)[:-1]


def test_too_few_landmarks_are_refused_with_the_missing_ones() -> None:
    few = {name: points()[name] for name in ("nose_tip", "chin", "mouth_left")}
    message = r"face\.csv: 3 of the model's 6 .*missing are right_eye_outer, left_eye_outer, mouth_"
    with pytest.raises(InputError, match=message):
        check_landmarks(few, small_model(), name="face.csv")


def test_a_model_without_landmarks_says_how_to_give_them() -> None:
    bare = small_model().crop(np.arange(63) < 14)
    with pytest.raises(InputError, match=r"small has no landmarks; give a \.json file of names"):
        check_landmarks(points(), bare)


def test_landmarks_that_are_not_finite_are_refused() -> None:
    with pytest.raises(InputError, match="The landmarks: chin are not finite"):
        check_landmarks(points() | {"chin": np.array([0, np.nan, 0])}, small_model())


def test_landmarks_far_from_the_mesh_are_refused() -> None:
    for given, times in ((points() | {"chin": np.array([0, 900.0, 0])}, "4"), ({}, "9.6")):
        other = given or {name: point / 10 - 1000 for name, point in points().items()}
        with pytest.raises(InputError, match=rf"is {times}.* times the length of dome away"):
            check_landmarks(other, small_model(), dome())


def test_landmarks_in_one_place_are_refused() -> None:
    with pytest.raises(InputError, match="lie on a line"):
        check_landmarks({name: np.ones(3) for name in LANDMARKS}, small_model())


def test_mirrored_landmarks_are_refused() -> None:
    swapped = {name: points()[_other_side(name)] for name in LANDMARKS}
    with pytest.raises(InputError, match="appear mirrored; swap left and right"):
        check_landmarks(swapped, small_model(), dome())
    rng = np.random.default_rng(0)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    rotated = {name: 3 * rotation @ point + 7 for name, point in points().items()}
    assert check_landmarks(rotated, small_model()) == list(LANDMARKS)


def test_landmarks_in_a_plane_have_no_side() -> None:
    flat = {name: point * [1, 1, 0] for name, point in points().items()}
    assert check_landmarks(flat, small_model()) == list(LANDMARKS)


def _other_side(name: str) -> str:
    pair = name.replace("left", "L").replace("right", "left").replace("L", "right")
    return pair if pair in LANDMARKS else name
