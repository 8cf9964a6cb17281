"""Looks whose melanin is known."""

import numpy as np
import pytest

from skinnet.video._look_series import LookSeries, describe_constancy

FACE = np.ones(50, bool)


def make_series(levels: dict[float, float], start: float = 2.0) -> LookSeries:
    """Looks of evenly coloured faces, at times from 0; those until the start are the baseline's."""
    series, started = LookSeries(), False
    for time, level in levels.items():
        if time > start and not started:
            series.start(start)
            started = True
        series.add(time, np.full(50, level, np.float32), 1.0)
    return series


def test_all_of_the_shot_counts_alike() -> None:
    levels = {0.0: 0.05, 0.5: 0.05, 1.0: 0.05, 1.5: 0.05, 2.0: 0.05, 4.0: 0.06, 6.0: 0.06}
    pooled = make_series(levels).pool(FACE)
    assert 0.055 < pooled.texels[0] < 0.06 and pooled.weights.sum() == pytest.approx(1)


def test_a_look_that_is_far_off_does_little() -> None:
    levels = {2.0 * number: 0.05 for number in range(8)} | {16.0: 0.2}
    assert make_series(levels).pool(FACE).texels[0] < 0.055


def test_memory_does_not_grow_and_looks_stay_spread() -> None:
    series, time = make_series({0.0: 0.05}), 2.0
    series.start(0.0)
    count = 0
    while time < 3600:
        if series.is_due(time):
            series.postpone(time)
            series.add(time, np.full(50, 0.05, np.float32), 1.0)
            count += 1
        time += 0.5
    times = series.pool(FACE).times
    assert len(times) < 20 and times[-1] > 2400 and count < 120
    assert np.ptp(np.diff(times[1:])) < 300


def test_constancy_is_described() -> None:
    levels = {float(number): 0.05 * (1.02 if number > 5 else 1.0) for number in range(12)}
    found = describe_constancy([(1, make_series(levels, 20.0).pool(FACE))])
    assert len(found["looks"]) == 12 and found["drift"] == pytest.approx(np.log(1.02), abs=1e-3)
    assert 0 < found["standard_error"] < found["spread"] < 0.02


def test_a_single_look_has_no_spread() -> None:
    found = describe_constancy([(1, make_series({0.0: 0.05}).pool(FACE))])
    assert found["spread"] is None and found["drift"] is None
