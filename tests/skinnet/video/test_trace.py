"""A trace that does not grow."""

import numpy as np

from skinnet.video._trace import MOST, Trace


def test_memory_is_bounded_and_means_stay() -> None:
    trace = Trace(2)
    for number in range(5 * MOST):
        trace.add(np.array([number, np.nan if number % 2 else 1.0]))
    rows = trace.rows()
    assert MOST // 2 <= len(rows) <= MOST
    assert np.allclose(rows[:, 1], 1) and np.all(np.diff(rows[:, 0]) > 0)


def test_what_is_never_seen_stays_unknown() -> None:
    trace = Trace(1)
    trace.add(np.array([np.nan]))
    assert np.isnan(trace.rows()).all()
