"""Distances of recorded colours from the colour surface of the model."""

import numpy as np
from scipy.optimize import approx_fprime

from benchmarks.calibration import MIX, known_colours, model_colours
from skinnet.calibration._distance import GamutDistance


def test_colours_of_the_gamut_have_no_distance_and_find_their_model_colours() -> None:
    data = known_colours(MIX, "paler", noise=0, count=300)
    match = GamutDistance(data, model_colours(), 0.2).match(MIX)
    assert match.distance.max() < 1e-3
    np.testing.assert_allclose((MIX @ match.model).T, data, rtol=2e-3)


def test_derivatives_are_those_of_the_distance() -> None:
    data = known_colours(MIX, "paler", noise=0.02, count=300)
    distance = GamutDistance(data, model_colours(), 0.2)
    start = 1.05 * MIX
    match = distance.match(start)

    def measure(entries: np.ndarray) -> np.ndarray:
        return distance.match(entries.reshape(3, 3)).distance

    numerical = approx_fprime(start.ravel(), measure, 1e-6)
    sharp = match.distance > 1e-2
    np.testing.assert_allclose(match.derivatives[sharp], numerical[sharp], rtol=0.02, atol=0.02)


def test_coverage_is_better_under_the_true_transform_than_under_a_brighter_one() -> None:
    distance = GamutDistance(known_colours(MIX, count=3000), model_colours(), 0.2)
    assert distance.measure_coverage(MIX) < 0.5 * distance.measure_coverage(2 * MIX)
