"""Fused readings against scipy, least squares and simulated people."""

import numpy as np
import pytest
from scipy import optimize, stats

from skinnet.inference._fusion import SHARED, fuse_readings

Y, S = np.log([0.045, 0.05, 0.05, 0.055]), np.array([0.1, 0.2, 0.15, 0.3])


def test_independent_shots_are_a_fixed_effect_meta_analysis() -> None:
    fused = fuse_readings(Y, S)
    (mean,), ((variance,),) = optimize.curve_fit(
        lambda x, mean: mean + 0 * x, np.arange(4), Y, sigma=S, absolute_sigma=True
    )
    assert fused.value == pytest.approx(mean) and fused.sd == pytest.approx(np.sqrt(variance))
    q = (((Y - mean) / S) ** 2).sum()
    assert fused.q == pytest.approx(q) and fused.freedom == 3
    assert fused.p == pytest.approx(stats.chi2.sf(q, 3)) and fused.birge_ratio == 1


def test_disagreement_widens_as_least_squares_with_unknown_scale_does() -> None:
    y = Y + [0, 0.5, -0.6, 0]
    fused = fuse_readings(y, S)
    _, ((variance,),) = optimize.curve_fit(
        lambda x, mean: mean + 0 * x, np.arange(4), y, sigma=S, absolute_sigma=False
    )
    assert fused.birge_ratio == pytest.approx(np.sqrt(fused.q / 3)) and fused.birge_ratio > 1
    assert fused.sd == pytest.approx(np.sqrt(variance))


def test_the_variance_is_that_of_correlated_errors() -> None:
    sessions = [0, 0, 1, 2]
    same = np.equal.outer(sessions, sessions)
    covariance = np.where(same, 1, 0.4) * np.outer(S, S)
    rng = np.random.default_rng(0)
    errors = stats.multivariate_normal(np.zeros(4), covariance, allow_singular=True)
    y = errors.rvs(200_000, random_state=rng)
    fused = fuse_readings(y, S, 0.4, sessions)
    assert (fused.sd / fused.birge_ratio)[0] == pytest.approx(fused.value.std(), rel=0.01)


@pytest.mark.parametrize("shots", [2, 5])
def test_one_session_is_as_sure_as_one_shot(shots: int) -> None:
    fused = fuse_readings(np.zeros(shots), np.full(shots, 0.2), 0.5, np.zeros(shots, int))
    assert fused.sd == pytest.approx(0.2)
    assert fuse_readings(np.zeros(shots), np.full(shots, 0.2), 0.5).sd == pytest.approx(
        0.2 * np.sqrt(0.5 + 0.5 / shots)
    )


@pytest.mark.parametrize("shared", SHARED.values())
def test_intervals_cover_and_q_is_uniform_if_errors_are_as_stated(shared: float) -> None:
    rng = np.random.default_rng(0)
    sd = rng.uniform(0.1, 0.3, (20_000, 1))
    common, own = rng.standard_normal((20_000, 1)), rng.standard_normal((20_000, 5))
    errors = sd * (np.sqrt(shared) * common + np.sqrt(1 - shared) * own)
    fused = fuse_readings(errors, sd, shared)
    assert stats.kstest(fused.p, "uniform").pvalue > 0.01
    assert (np.abs(fused.value) < 1.645 * fused.sd).mean() == pytest.approx(0.92, abs=0.02)


def test_intervals_stay_honest_if_shots_state_half_of_their_own_error() -> None:
    rng = np.random.default_rng(0)
    errors = 0.2 * (0.7 * rng.standard_normal((20_000, 1)) + 1.4 * rng.standard_normal((20_000, 5)))
    fused = fuse_readings(errors, np.full(5, 0.2), 0.49)
    assert (np.abs(fused.value) < 1.645 * fused.sd).mean() > 0.88
    assert (np.abs(fused.value) < 1.645 * fused.sd / fused.birge_ratio).mean() < 0.85


def test_hidden_shots_do_not_count() -> None:
    hidden = fuse_readings([*Y, np.nan], [*S, 0.1], 0.3, [0, 1, 1, 2, 2])
    seen = fuse_readings(Y, S, 0.3, [0, 1, 1, 2])
    assert [float(each) for each in hidden] == pytest.approx([float(each) for each in seen])
    one = fuse_readings([np.nan, Y[0]], [np.nan, S[0]], 0.3)
    assert (one.value, one.sd, one.q, one.freedom, one.p) == pytest.approx((Y[0], S[0], 0, 0, 1))
    none = fuse_readings([np.nan, np.nan], S[:2])
    assert np.isnan(none.value) and np.isnan(none.sd)
