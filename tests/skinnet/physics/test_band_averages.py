"""Averages over bands keep the power of a spectrum."""

import numpy as np
import pytest

from skinnet.physics._band_averages import average_over_bands

BANDS = np.arange(400.0, 721.0, 10.0)


def average(wavelength: np.ndarray, values: np.ndarray) -> np.ndarray:
    return average_over_bands(wavelength, values[:, None], BANDS)[:, 0]


def test_a_table_of_five_nanometres_has_the_weights_of_the_shipped_tables() -> None:
    wavelength = np.arange(380.0, 781.0, 5)
    values = np.random.default_rng(0).random(len(wavelength))
    fine = values[3:-11]
    exact = (fine[:-2:2] + 2 * fine[1:-1:2] + fine[2::2]) / 4
    np.testing.assert_allclose(average(wavelength, values), exact, rtol=1e-12)


@pytest.mark.parametrize("step", [10.0, 20.0, 40.0, 5.0, 2.5, 1.0])
def test_a_straight_line_stays_straight(step: float) -> None:
    wavelength = np.arange(360.0, 761.0, step)
    np.testing.assert_allclose(average(wavelength, 3 + wavelength), 3 + BANDS, rtol=1e-12)


def test_a_table_of_the_bands_is_taken_as_it_is() -> None:
    values = np.random.default_rng(0).random(33)
    np.testing.assert_allclose(average(BANDS, values), values, rtol=1e-12)


def test_the_sum_is_the_integral_of_irregular_rows() -> None:
    rng = np.random.default_rng(0)
    wavelength = np.sort(np.concatenate([[350.0, 780.0], rng.uniform(350, 780, 500)]))
    inside = (wavelength > 396) & (wavelength < 724)
    values = rng.random(len(wavelength)) * inside
    whole = np.trapezoid(values, wavelength)
    assert 10 * average(wavelength, values).sum() == pytest.approx(whole, rel=1e-12)


def test_a_band_at_the_end_is_averaged_over_what_is_covered() -> None:
    wavelength = np.arange(400.0, 721.0)
    found = average(wavelength, wavelength)
    assert found[0] == pytest.approx(402.5, abs=0.3)
    assert found[1] == pytest.approx(410)
