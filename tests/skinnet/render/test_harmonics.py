"""Spherical harmonics against their definition."""

from math import factorial

import numpy as np
from scipy.special import lpmv

from skinnet.mesh._vectors import normalise
from skinnet.render._harmonics import COSINE_LOBE, evaluate_harmonics

DIRECTIONS = normalise(np.random.default_rng(0).normal(size=(50, 3)))


def test_harmonics_are_those_of_their_definition() -> None:
    x, y, z = DIRECTIONS.T
    azimuth = np.arctan2(y, x)
    expected = []
    for degree in range(3):
        for order in range(-degree, degree + 1):
            m = abs(order)
            ratio = factorial(degree - m) / factorial(degree + m)
            scale = np.sqrt((2 * degree + 1) / (4 * np.pi) * ratio) * (-1) ** m
            wave = np.sqrt(2) * (np.cos if order > 0 else np.sin)(m * azimuth) if order else 1
            expected.append(scale * lpmv(m, degree, z) * wave)
    assert np.allclose(evaluate_harmonics(DIRECTIONS), np.stack(expected, 1))


def test_the_cosine_lobe_is_the_clamped_cosine_expanded() -> None:
    height, weight = np.polynomial.legendre.leggauss(200)
    for degree, number in ((0, 0), (1, 2), (2, 6)):
        legendre = np.polynomial.legendre.Legendre.basis(degree)(height)
        integral = (weight * height.clip(0) * legendre).sum()
        assert np.isclose(COSINE_LOBE[number], 2 * integral, atol=1e-4)
