"""Edits of pigments are weighed by a mask, clipped, and leave the offset alone."""

import numpy as np
import pytest

from benchmarks.appearance import make_person
from skinnet.appearance import PigmentEdit, edit_texture
from skinnet.errors import InputError


def test_a_mask_weighs_the_edit() -> None:
    face = make_person(20, 0)
    mask = np.full((20, 20), 0.25)
    edited = edit_texture(face, PigmentEdit(paint=0.2), PigmentEdit(scale=2.0, add=0.01), mask)
    assert np.allclose(edited.f_mel, 0.75 * face.f_mel + 0.05)
    assert np.allclose(edited.f_blood, face.f_blood + 0.25 * (face.f_blood + 0.01), atol=1e-6)
    assert np.array_equal(edited.offset, face.offset)


def test_fractions_stay_in_the_unit_interval() -> None:
    fraction = np.array([0.0, 0.5, 1.0], np.float32)
    assert PigmentEdit(scale=3.0, add=-0.1)(fraction).tolist() == [0, 1, 1]


def test_a_mask_of_another_size_is_refused() -> None:
    with pytest.raises(InputError, match="mask is 8 x 8 and the maps of person 0 are 20 x 20"):
        edit_texture(make_person(20, 0), PigmentEdit(), PigmentEdit(), np.ones((8, 8)))


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"scale": -1.0}, "scale is a factor from 0 to 10; got -1.0"),
        ({"add": 20.0}, "add is a volume fraction .* got 20.0. Was it given in percent"),
        ({"paint": 5.0}, "paint is a volume fraction .* got 5.0. Was it given in percent"),
    ],
)
def test_values_outside_their_range_are_refused(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        PigmentEdit(**values)
