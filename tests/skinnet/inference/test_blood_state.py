"""States of blood are checked, and laid out on the maps that were read."""

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.images import Box
from skinnet.inference._blood_state import check_state, place_state


class Doubled:
    """A state that doubles the blood of skin right of the first landmark."""

    @property
    def amounts(self) -> dict[str, float]:
        return {"doubled": 1.0}

    def __call__(
        self, hemoglobin: np.ndarray, landmarks: np.ndarray, skin: np.ndarray, most: float
    ) -> np.ndarray:
        right = np.arange(hemoglobin.shape[1]) + 0.5 > landmarks[0, 0]
        return np.where(right & (skin > 0), np.minimum(2 * hemoglobin, most), hemoglobin)


def test_what_is_no_state_is_refused() -> None:
    with pytest.raises(InputError, match=r"state is a change of blood, such as .*; got \{'flush'"):
        check_state({"flush": 1.0}, "face")
    with pytest.raises(InputError, match="leave out one of them"):
        check_state(Doubled(), "skin")
    check_state(None, "skin")
    check_state(Doubled(), "face")


def test_landmarks_are_those_of_the_map() -> None:
    landmarks = np.full((478, 2), 50, np.float32)
    blood = np.full((1, 8, 8), 0.05, np.float32)
    outputs = {"hemoglobin": blood, "mask": np.ones_like(blood)}
    placed = place_state(Doubled(), outputs, landmarks, Box(10, 10, 90, 90), 0.08)
    assert placed.shape == (1, 8, 8)
    assert (placed[..., :4] == np.float32(0.05)).all() and (placed[..., 4:] == 0.08).all()
