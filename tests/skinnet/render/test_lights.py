"""Lights: irradiance equals integrals done by hand or by sums over the sphere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skinnet.mesh._vectors import normalise
from skinnet.render._harmonics import evaluate_harmonics
from skinnet.render.lights import SphericalHarmonics


def sphere(count: int = 200_000) -> np.ndarray:
    """Directions evenly over the sphere."""
    number = np.arange(count) + 0.5
    y, azimuth = 1 - 2 * number / count, number * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - y * y)
    return np.stack([ring * np.cos(azimuth), y, ring * np.sin(azimuth)], 1)


@given(st.integers(0, 10**6))
def test_irradiance_is_the_cosine_weighted_integral_over_pi(seed: int) -> None:
    rng = np.random.default_rng(seed)
    coefficients = rng.normal(size=(9, 3))
    coefficients[0] += 6
    normals = normalise(rng.normal(size=(4, 3)))
    directions = sphere(20_000)
    radiance = evaluate_harmonics(directions) @ coefficients
    cosine = (normals @ directions.T).clip(0)
    expected = cosine @ radiance * 4 * np.pi / len(directions) / np.pi
    light = SphericalHarmonics(coefficients)
    assert np.allclose(light.irradiance(normals), expected.clip(0), atol=5e-3)


def test_constant_radiance_lights_a_white_surface_as_itself() -> None:
    grey = SphericalHarmonics.project(lambda directions: np.full(directions.shape, 0.7))
    assert grey.coefficients[0] == pytest.approx([0.7 * np.sqrt(4 * np.pi)] * 3)
    normals = normalise(np.random.default_rng(0).normal(size=(20, 3)))
    assert np.allclose(grey.irradiance(normals), 0.7)
    one = SphericalHarmonics(np.r_[0.7 * np.sqrt(4 * np.pi), np.zeros(8)])
    assert np.allclose(one.irradiance(normals), 0.7)


def test_projection_gives_back_coefficients() -> None:
    coefficients = np.random.default_rng(0).normal(size=(9, 3))
    found = SphericalHarmonics.project(
        lambda directions: evaluate_harmonics(directions) @ coefficients
    )
    assert np.allclose(found.coefficients, coefficients, atol=1e-12)


def test_a_sky_is_bright_above() -> None:
    sky = SphericalHarmonics.sky((1.0, 0.8, 0.6), (0.2, 0.1, 0.0))
    top, side, bottom = sky.irradiance(np.array([[0.0, 1, 0], [1, 0, 0], [0, -1, 0]]))
    # The cosine lobe keeps two thirds of what is linear.
    assert top == pytest.approx([0.6 + 0.4 * 2 / 3, 0.45 + 0.35 * 2 / 3, 0.3 + 0.3 * 2 / 3])
    assert side == pytest.approx([0.6, 0.45, 0.3])
    assert bottom == pytest.approx([0.6 - 0.4 * 2 / 3, 0.45 - 0.35 * 2 / 3, 0.1])
    ground = sky.project(lambda d: 0.1 + 0.45 * (1 + d[:, 1:2]) * np.ones(3))
    assert np.allclose(ground.coefficients[4:], 0, atol=1e-12)


def test_no_light_is_negative() -> None:
    coefficients = np.zeros(9)
    coefficients[1] = 1.0
    assert SphericalHarmonics(coefficients).irradiance(np.array([[0.0, -1, 0]])).min() == 0
