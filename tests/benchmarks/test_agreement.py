"""Agreement of readings, and what is measured beside it."""

import numpy as np
import pytest

from benchmarks.agreement import (
    compare_with_other,
    estimate_variances,
    measure_agreement,
    measure_coverage,
)

SHROUT_FLEISS = np.array(
    [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]], float
)
"""Table 2 of Shrout & Fleiss 1979: four judges' ratings of six targets."""


def simulate(people: int, between: float, within: float, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(0, between, (people, 1)) + rng.normal(0, within, (people, 2))


def test_a_published_example_has_its_published_correlation() -> None:
    found = estimate_variances(SHROUT_FLEISS)
    # Mean squares of table 3: 11.24 between targets, 6.26 within them; ICC(1,1) of table 4.
    assert found.within == pytest.approx(6.26, abs=0.005)
    assert 4 * found.between + found.within == pytest.approx(11.24, abs=0.005)
    assert found.icc == pytest.approx(0.17, abs=0.005)


def test_known_spreads_are_found_and_the_interval_holds_the_true_correlation() -> None:
    found = measure_agreement(simulate(2000, 0.3, 0.1), draws=200)
    assert found is not None and found["people"] == 2000
    assert found["between_sd"] == pytest.approx(0.3, rel=0.05)
    assert found["within_sd"] == pytest.approx(0.1, rel=0.05)
    low, high = found["icc_interval"]
    assert low < 0.9 < high and high - low < 0.05


def test_people_without_a_reading_are_left_out() -> None:
    values = simulate(50, 1, 1)
    with_gaps = np.concatenate([values, [[np.nan, 1.0], [2.0, np.nan]]])
    assert measure_agreement(with_gaps) == measure_agreement(values)
    assert measure_agreement(values[:2]) is None


def test_a_perfect_reading_is_valid_and_a_constant_one_has_no_rank() -> None:
    rng = np.random.default_rng(0)
    person = rng.normal(0, 10, (4000, 1))
    raw = person + rng.normal(0, 20, (4000, 2))
    found = compare_with_other(np.repeat(person, 2, 1), raw)
    assert found["validity"] == pytest.approx(1, abs=0.06)
    assert found["rank_other"] == pytest.approx(0.45, abs=0.05)
    constant = compare_with_other(np.zeros((4000, 2)), raw)
    assert constant == {"rank_other": None, "validity": None}


def test_nine_tenths_of_differences_lie_within_the_true_interval() -> None:
    values, sd = simulate(5000, 1, 0.2), np.full((5000, 2), 0.2)
    assert measure_coverage(values, sd) == pytest.approx(0.9, abs=0.015)
    assert measure_coverage(values, 10 * sd) == 1
