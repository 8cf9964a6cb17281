"""The pulse of signals whose rate is known."""

import numpy as np
import pytest

from skinnet.video._pulse import (
    PulseEstimate,
    PulseMeter,
    PulseSummary,
    find_peak,
    measure_spectrum,
)

BLOOD = np.array([-0.06, -0.2, -0.18])


def make_signal(rate: float, seconds: float = 14.0) -> tuple[np.ndarray, np.ndarray]:
    """Uneven times, and log colours with a pulse, a larger common movement and some noise."""
    rng = np.random.default_rng(0)
    times = np.cumsum(rng.uniform(0.02, 0.05, int(seconds / 0.035)))
    beat = np.sin(2 * np.pi * rate / 60 * times) + 0.3 * np.sin(4 * np.pi * rate / 60 * times)
    move = 0.008 * np.sin(2 * np.pi * 1.3 * times)
    return times, 0.02 * beat[:, None] * BLOOD + move[:, None] + rng.normal(
        0, 3e-4, (len(times), 3)
    )


@pytest.mark.parametrize("rate", [52.0, 95.0, 140.0])
def test_the_rate_is_found_under_movement(rate: float) -> None:
    meter, summary = PulseMeter(), PulseSummary()
    for time, ratios in zip(*make_signal(rate), strict=True):
        found = meter.add(float(time), ratios[None], BLOOD[None])
        if found is not None:
            summary.add(found)
    described = summary.describe()
    assert described["is_readable"] and abs(described["rate_bpm"] - rate) < 2


def test_noise_has_no_readable_pulse() -> None:
    meter, summary = PulseMeter(), PulseSummary()
    rng = np.random.default_rng(1)
    for number in range(400):
        found = meter.add(number / 30, rng.normal(0, 1e-3, (1, 3)), BLOOD[None])
        if found is not None:
            summary.add(found)
    described = summary.describe()
    assert not described["is_readable"] and described["rate_bpm"] is None


def test_a_summary_without_estimates_says_so() -> None:
    assert PulseSummary().describe()["rate_bpm"] is None


def test_a_gap_begins_anew() -> None:
    meter = PulseMeter()
    for number in range(300):
        meter.add(number / 30, np.sin(number / 5) * BLOOD[None], BLOOD[None])
    assert meter.add(20.0, BLOOD[None], BLOOD[None]) is None


def make_estimate(rate: float, clear: float, face: float | None = None) -> PulseEstimate:
    """An estimate whose spectra have so much of their power at a rate, and the rest everywhere."""
    even = np.random.default_rng(0).normal(0, 1, 360)
    signals = [np.sqrt(clear) * np.sin(2 * np.pi * each / 60 * np.arange(360) / 30)
               + np.sqrt(1 - clear) * 0.3 * even for each in (rate, face or rate)]  # fmt: skip
    spectra = np.stack([measure_spectrum(each) for each in signals])
    return PulseEstimate(0.0, *find_peak(signals[0]), spectra)


def test_the_rate_of_a_video_is_that_of_most_windows() -> None:
    summary = PulseSummary()
    for rate in (60.0, 60.5, 150.0, 60.0):
        summary.add(make_estimate(rate, 0.9))
    assert abs(summary.describe()["rate_bpm"] - 60) <= 1


@pytest.mark.parametrize(
    "estimates",
    [
        [make_estimate(60.0, 0.001)],
        [make_estimate(rate, 0.9) for rate in (50.0, 90.0, 140.0)],
        [make_estimate(60.0, 0.9, 97.0)],
    ],
    ids=["weak", "jumping", "contradicted"],
)
def test_a_pulse_that_is_weak_or_jumps_is_not_told(estimates: list) -> None:
    summary = PulseSummary()
    for estimate in estimates:
        summary.add(estimate)
    described = summary.describe()
    assert described["rate_bpm"] is None and described["quality"] > 0
    assert np.isfinite(summary.find_rate())
