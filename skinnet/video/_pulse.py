"""The pulse rate: periodic changes of hemoglobin, and how clear they are."""

from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

BAND = 0.67, 3.5
"""Frequencies in which a pulse is looked for, in Hz: 40 to 210 beats per minute."""

WINDOW, _EVERY, _LEAST = 12.0, 1.0, 6.0
"""Seconds that one estimate looks back, between two estimates, and before the first one."""

_RATE, _ZEROS = 30.0, 4096
_LOADING = 0.05
"""Share of the mean variance that is added to each signal's: without it, an error of the
direction would cancel the pulse itself."""

_LEAST_SEEN = 0.9
"""Share of the window in which a region is seen for it to count."""

_HALF_WIDTH = 0.1
"""Half of the width, in Hz, of the peak and of its first harmonic, which count as pulse."""

LEAST_QUALITY = 0.35
"""Quality below which a pulse cannot be read."""

_NEAR, _LEAST_NEAR = 6.0, 0.7
"""Beats per minute about the median, and the share of the estimates, weighed by their quality,
that lies within them at least: what jumps is noise that looks like a rhythm."""

Array = NDArray[np.float64]


class PulseEstimate(NamedTuple):
    """A pulse rate at a time.

    Attributes:
        time: End of the window, in seconds.
        rate: Beats per minute.
        quality: Share in [0, 1] of the power from 40 to 210 beats per minute that lies at the rate
            and at twice the rate.
    """

    time: float
    rate: float
    quality: float


class PulseMeter:
    """Estimates the pulse once a second from the colours of all regions in the last seconds."""

    def __init__(self) -> None:
        self._times: deque[float] = deque()
        self._ratios: deque[Array] = deque()
        self._next = -np.inf

    def clear(self) -> None:
        """Forget what was seen: a cut, or a face that was lost for long."""
        self._times.clear()
        self._ratios.clear()

    def add(self, time: float, ratios: Array, direction: Array) -> PulseEstimate | None:
        """Add log ratios of a frame.

        Args:
            time: Time stamp in seconds.
            ratios: Log ratio of linear RGB to the baseline, [regions, 3]; NaN where not seen.
            direction: Derivative of log RGB by log hemoglobin, [regions, 3].

        Returns:
            An estimate, once a second.
        """
        if self._times and time - self._times[-1] > 1.0:
            self.clear()
        self._times.append(time)
        self._ratios.append(ratios)
        while time - self._times[0] > WINDOW:
            self._times.popleft()
            self._ratios.popleft()
        if time < self._next or time - self._times[0] < _LEAST:
            return None
        self._next = time + _EVERY
        stacked = np.stack(self._ratios)
        seen = np.isfinite(stacked).all(2).mean(0) >= _LEAST_SEEN
        if not seen.any():
            return None
        count = len(stacked)
        signals = resample(np.array(self._times), stacked[:, seen].reshape(count, -1))
        if len(signals) < 4 * _RATE or not signals.any():
            return None
        return PulseEstimate(time, *find_peak(project(signals, direction[seen].ravel())))


def resample(times: Array, values: Array) -> Array:
    """Resample values [N, channels] evenly over gaps (NaN), and keep the pulse's band alone."""
    count = int((times[-1] - times[0]) * _RATE) + 1
    even = times[0] + np.arange(count) / _RATE
    finite = [np.isfinite(one) for one in values.T]
    signals = np.stack(
        [np.interp(even, times[on], one[on]) for on, one in zip(finite, values.T, strict=True)], -1
    )
    return filter_band(signals)


def filter_band(signals: Array) -> Array:
    """Keep the frequencies of a pulse in evenly sampled signals [N, channels]."""
    ramp = np.linspace(-1, 1, len(signals))[:, None]
    basis = np.concatenate([np.ones_like(ramp), ramp, ramp**2], 1)
    rest = signals - basis @ np.linalg.lstsq(basis, signals, rcond=None)[0]
    frequency = np.fft.rfftfreq(len(rest), 1 / _RATE)
    outside = (frequency < BAND[0]) | (frequency > 2 * BAND[1])
    spectrum = np.fft.rfft(rest, axis=0)
    spectrum[outside] = 0
    return np.asarray(np.fft.irfft(spectrum, len(rest), axis=0))


def project(signals: Array, direction: Array) -> Array:
    """Project colours on the change that blood makes: minimum variance, distortionless response.

    Of all weights that leave a change of blood as it is, these have the least variance: they cancel
    movement and light, whatever their colour.

    Args:
        signals: Log RGB of all regions in the pulse's band, [N, channels].
        direction: What blood does to them, [channels].

    Source:
        J. Capon, High-resolution frequency-wavenumber spectrum analysis, Proceedings of the IEEE
        57, 1969, with the direction of the skin model instead of a steering vector.
    """
    covariance = signals.T @ signals / len(signals)
    loaded = covariance + _LOADING * np.trace(covariance) / len(covariance) * np.eye(
        len(covariance)
    )
    weights = np.linalg.solve(loaded, direction)
    return np.asarray(signals @ (weights / max(float(weights @ direction), 1e-12)))


def find_peak(signal: Array) -> tuple[float, float]:
    """Find the pulse rate of an evenly sampled signal [N], and its quality."""
    windowed = signal * np.hanning(len(signal))
    power = np.abs(np.fft.rfft(windowed, _ZEROS)) ** 2
    frequency = np.fft.rfftfreq(_ZEROS, 1 / _RATE)
    band = (frequency >= BAND[0]) & (frequency <= BAND[1])
    peak = float(frequency[np.where(band, power, 0).argmax()])
    near = np.abs(frequency - peak) <= _HALF_WIDTH
    near |= (np.abs(frequency - 2 * peak) <= _HALF_WIDTH) & band
    total = float(power[band].sum())
    return 60 * peak, float(power[near & band].sum()) / total if total > 0 else 0.0


class PulseSummary:
    """The pulse of a whole video: a histogram, so that memory does not grow with length."""

    _STEP = 0.25

    def __init__(self) -> None:
        self._counts = np.zeros(round(60 * 2 * BAND[1] / self._STEP))
        self._estimates, self._quality = 0, 0.0

    def add(self, estimate: PulseEstimate) -> None:
        """Add an estimate, weighed by its quality."""
        self._counts[int(estimate.rate / self._STEP)] += estimate.quality**2
        self._estimates += 1
        self._quality += estimate.quality

    def describe(self) -> dict[str, float | int | bool | None]:
        """Median rate weighed by quality, for JSON; `rate_bpm` is None if it cannot be read."""
        if not self._estimates:
            return {"rate_bpm": None, "quality": None, "is_readable": False, "estimates": 0}
        rate, quality = self.find_median(), self._quality / self._estimates
        is_readable = quality >= LEAST_QUALITY and self._agree(rate)
        return {
            "rate_bpm": rate if is_readable else None,
            "quality": round(quality, 4),
            "is_readable": is_readable,
            "estimates": self._estimates,
        }

    def find_median(self) -> float:
        """Median of the estimates weighed by quality, readable or not; NaN without any."""
        if not self._estimates:
            return float("nan")
        share = np.cumsum(self._counts) / self._counts.sum()
        return (int(np.searchsorted(share, 0.5)) + 0.5) * self._STEP

    def _agree(self, rate: float) -> bool:
        rates = (np.arange(len(self._counts)) + 0.5) * self._STEP
        near = self._counts[np.abs(rates - rate) <= _NEAR].sum()
        return bool(near >= _LEAST_NEAR * self._counts.sum())
