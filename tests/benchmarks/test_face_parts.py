import numpy as np
import pytest

from benchmarks.face_parts import compare, fill, measure_agreement


def test_colours_are_relative_to_the_wall() -> None:
    photo = np.full((100, 100, 3), (120, 110, 100), np.uint8)
    photo[40:60, 40:60] = (200, 110, 100)
    assert compare(photo[0], photo) == pytest.approx([1, 1], rel=1e-4)
    red, blue = compare(photo[50, 45:55], photo)
    assert red > 2 and blue == pytest.approx(1, rel=1e-4)
    assert np.isnan(compare(photo[0, :0], photo)).all()


def test_outlines_of_a_template_are_filled() -> None:
    template = np.array([[2, 2], [7, 2], [7, 5], [2, 5]], float)
    filled = fill(template, [(0, 1, 2, 3)], (10, 12))
    assert filled.shape == (10, 12) and filled[2:6, 2:8].all() and filled.sum() == 24


def test_agreement_is_over_people_whose_region_is_seen_twice() -> None:
    pairs = []
    for value in (0.1, 0.2, 0.3, 0.4):
        first = {"nose": (value, -value), "all": (value, value)}
        second = {"nose": (value**2, value), "all": (value, value**2)}
        pairs.append((first, second))
    pairs[0][1]["nose"] = (np.nan, np.nan)
    found = measure_agreement(pairs)
    assert found["people"] == found["all"]["people"] == 4
    assert found["nose"]["people"] == 3
    assert found["nose"]["melanin"] == pytest.approx(1)
    assert found["nose"]["hemoglobin"] == pytest.approx(-1)
    assert found["nose"]["hemoglobin_of_all"] == pytest.approx(1)
