"""Noise of series whose covariance is known."""

import numpy as np

from skinnet.video._noise import RunningNoise


def test_noise_is_found_beside_slow_changes() -> None:
    rng, noise = np.random.default_rng(0), RunningNoise(2)
    for number in range(400):
        slow = 0.3 * np.sin(number / 150)
        noise.add(number / 30, slow + rng.normal(0, [0.01, 0.02, 0.04], (2, 3)))
    sds = np.sqrt(np.diagonal(noise.covariance, axis1=1, axis2=2))
    assert np.allclose(sds, [0.01, 0.02, 0.04], rtol=0.4)


def test_a_region_that_is_hidden_keeps_its_noise() -> None:
    rng, noise = np.random.default_rng(0), RunningNoise(1)
    for number in range(60):
        noise.add(number / 30, rng.normal(0, 0.01, (1, 3)))
    before = noise.covariance
    noise.add(2.1, np.full((1, 3), np.nan))
    assert np.allclose(noise.covariance, before)
