"""Hulls and colours of the benchmark of edits."""

import numpy as np
import pytest
from skimage.color import rgb2lab

from benchmarks.edits import compute_excess, compute_lab, layout, measure
from skinnet.images import linear_to_srgb


def test_lab_is_that_of_scikit_image() -> None:
    linear = np.random.default_rng(0).random((50, 3)) ** 3
    assert np.allclose(compute_lab(linear), rgb2lab(linear_to_srgb(linear)), atol=0.05)


def test_excess_is_the_distance_to_the_hull() -> None:
    square = [[50.0, a, b] for a in (0, 2) for b in (0, 2)] * 3
    measured = np.array([*square, [40.0, 0, 0], [60.0, 0, 0]])
    lab = np.array([[50.0, 1, 1], [50.0, 3, 1], [90.0, 1, 1]])
    assert np.allclose(compute_excess(lab, measured), [-1, 1, np.nan], equal_nan=True)


def test_the_default_skin_beats_the_former_one() -> None:
    found = measure(melanin=(0.5,), blood=())
    ours, former = (found[name]["melanin x 0.5"] for name in ("measured", "calibrated"))
    assert ours["inside"] > 0.8 > 0.5 > former["inside"]
    assert found["unedited"]["inside"] == pytest.approx(0.926, abs=0.01)
    assert "| `measured`, melanin x 0.5 | 0.8" in layout(found)
