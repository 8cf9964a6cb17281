"""Changes in percent, and the ellipse in which no change lies."""

import numpy as np
import pytest
from scipy import stats

from skinnet.inference._comparison.changes import Change, PigmentChanges
from skinnet.inference._comparison.picture import CHANGE, describe_change


def test_an_interval_is_that_of_a_gaussian() -> None:
    change = Change(0.2, 0.1)
    np.testing.assert_allclose(change.interval, stats.norm(0.2, 0.1).interval(0.9))
    assert change.percent == pytest.approx(100 * (np.exp(0.2) - 1)) and not change.unchanged
    assert Change(0.1, 0.1).unchanged


def test_both_are_unchanged_within_their_ellipse() -> None:
    covariance = np.array([[0.04, -0.01], [-0.01, 0.09]])
    edge = np.array([0.3, 0.4])
    edge *= np.sqrt(stats.chi2(2).ppf(0.9) / (edge @ np.linalg.solve(covariance, edge)))
    assert PigmentChanges.from_moments(0.999 * edge, covariance).unchanged
    assert not PigmentChanges.from_moments(1.001 * edge, covariance).unchanged


def test_the_scale_has_no_change_in_its_lightest_middle() -> None:
    labels = dict(CHANGE.label())
    assert labels == {"-75": 0, "-50": 0.25, "0": 0.5, "+100": 0.75, "+300 %": 1}
    colours = CHANGE.colour(np.log([0.25, 0.5, 1, 2, 4])).astype(int)
    assert colours[2].min() > 240 and colours[0, 2] > colours[0, 0] and colours[4, 0] > 100


def test_a_change_is_described_in_percent() -> None:
    assert describe_change(Change(np.log(1.5), 0.0)) == "+50 % (+50 to +50 %)"
