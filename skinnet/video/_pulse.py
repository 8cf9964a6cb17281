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

_EMPHASIS = 0.5
"""Power of the frequency that weighs the face's signal: movements are slower than a pulse."""

_FREQUENCY = np.fft.rfftfreq(_ZEROS, 1 / _RATE)
_IN_BAND = (_FREQUENCY >= BAND[0]) & (_FREQUENCY <= BAND[1])
_BINS = _FREQUENCY[_IN_BAND]

LEAST_QUALITY = 0.35
"""Quality below which a pulse cannot be read."""

Array = NDArray[np.float64]


class PulseEstimate(NamedTuple):
    """A pulse rate at a time.

    Attributes:
        time: End of the window, in seconds.
        rate: Beats per minute.
        quality: Share in [0, 1] of the power from 40 to 210 beats per minute that lies at the rate
            and at twice the rate.
        spectra: Share of the power in the pulse's band, of all regions and of the face alone,
            [2, bins], times the share of the window that is filled.
    """

    time: float
    rate: float
    quality: float
    spectra: Array


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
            ratios: Log ratio of linear RGB to the baseline, [regions, 3], of the face first; NaN
                where not seen.
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
        signals = resample(np.array(self._times), stacked.reshape(len(stacked), -1))
        if len(signals) < 4 * _RATE or not signals.any():
            return None
        return self._estimate(time, signals, direction, seen)

    def _estimate(
        self, time: float, signals: Array, direction: Array, seen: NDArray[np.bool_]
    ) -> PulseEstimate:
        """Estimate from the signals of all regions [N, 3 regions]."""
        parts = seen & (np.arange(len(seen)) > 0)
        chosen = np.repeat(parts if parts.any() else seen, 3)
        whole = project(signals[:, chosen], direction.ravel()[chosen])
        rate, quality = find_peak(whole)
        spectra = measure_spectrum(whole)[None].repeat(2, 0)
        if seen[0]:
            face = project(signals[:, :3], direction[0], _EMPHASIS)
            spectra[1] = measure_spectrum(face, _EMPHASIS)
        spectra *= min((self._times[-1] - self._times[0]) / WINDOW, 1.0)
        return PulseEstimate(time, rate, quality, spectra)


def resample(times: Array, values: Array) -> Array:
    """Resample values [N, channels] evenly over gaps (NaN), and keep the pulse's band alone."""
    count = int((times[-1] - times[0]) * _RATE) + 1
    even = times[0] + np.arange(count) / _RATE
    finite = [np.isfinite(one) for one in values.T]
    signals = np.stack(
        [
            np.interp(even, times[on], one[on]) if on.any() else np.zeros(count)
            for on, one in zip(finite, values.T, strict=True)
        ],
        -1,
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


def project(signals: Array, direction: Array, emphasis: float = 0.0) -> Array:
    """Project colours on the change that blood makes: minimum variance, distortionless response.

    Of all weights that leave a change of blood as it is, these have the least variance: they cancel
    movement and light, whatever their colour.

    Args:
        signals: Log RGB of all regions in the pulse's band, [N, channels].
        direction: What blood does to them, [channels].
        emphasis: Power of the frequency that weighs what the variance is measured of.

    Source:
        J. Capon, High-resolution frequency-wavenumber spectrum analysis, Proceedings of the IEEE
        57, 1969, with the direction of the skin model instead of a steering vector.
    """
    weighed = _emphasise(signals, emphasis) if emphasis else signals
    covariance = weighed.T @ weighed / len(weighed)
    loaded = covariance + _LOADING * np.trace(covariance) / len(covariance) * np.eye(
        len(covariance)
    )
    weights = np.linalg.solve(loaded, direction)
    return np.asarray(signals @ (weights / max(float(weights @ direction), 1e-12)))


def _emphasise(signals: Array, power: float) -> Array:
    weights = np.fft.rfftfreq(len(signals), 1 / _RATE)[:, None] ** power
    return np.asarray(np.fft.irfft(weights * np.fft.rfft(signals, axis=0), len(signals), axis=0))


def measure_spectrum(signal: Array, emphasis: float = 0.0) -> Array:
    """Measure the share of the power at each frequency of the pulse's band, [bins].

    Args:
        signal: Evenly sampled, [N].
        emphasis: Power of the frequency that weighs amplitudes.
    """
    power = np.abs(np.fft.rfft(signal * np.hanning(len(signal)), _ZEROS)[_IN_BAND]) ** 2
    power = power * _BINS ** (2 * emphasis)
    return np.asarray(power / max(float(power.sum()), 1e-300))


def find_peak(signal: Array) -> tuple[float, float]:
    """Find the pulse rate of an evenly sampled signal [N], and its quality."""
    share = measure_spectrum(signal)
    peak = float(_BINS[share.argmax()])
    return 60 * peak, _measure_quality(share, peak)


def _measure_quality(share: Array, peak: float) -> float:
    """Share of the power [bins] at a frequency in Hz and at its first harmonic."""
    near = np.abs(_BINS - peak) <= _HALF_WIDTH
    near |= np.abs(_BINS - 2 * peak) <= _HALF_WIDTH
    return float(share[near].sum())


class PulseSummary:
    """The pulse of a whole video: sums of spectra, whose memory does not grow.

    Noise jumps from window to window, and a pulse does not: it is the peak of the sum of all
    spectra. Those of all regions together tell which peak it is, and that of the face alone, in
    which less noise of small regions is, where exactly it lies.
    """

    def __init__(self) -> None:
        self._spectra = np.zeros((2, len(_BINS)))
        self._estimates = 0

    def add(self, estimate: PulseEstimate) -> None:
        """Add an estimate."""
        self._spectra = self._spectra + estimate.spectra
        self._estimates += 1

    def describe(self) -> dict[str, float | int | bool | None]:
        """Describe it for JSON; `rate_bpm` is None if it cannot be read.

        It can if enough power lies at it, and if the face alone has its clearest rhythm there, too.
        """
        if not self._estimates:
            return {"rate_bpm": None, "quality": None, "is_readable": False, "estimates": 0}
        rate = self.find_rate()
        whole, face = self._spectra
        quality = _measure_quality(whole / whole.sum(), rate / 60)
        agrees = abs(_BINS[face.argmax()] - rate / 60) <= _HALF_WIDTH
        is_readable = bool(quality >= LEAST_QUALITY and agrees)
        return {
            "rate_bpm": round(rate, 2) if is_readable else None,
            "quality": round(quality, 4),
            "is_readable": is_readable,
            "estimates": self._estimates,
        }

    def find_rate(self) -> float:
        """Find the rate, readable or not; NaN without any estimate."""
        if not self._estimates:
            return float("nan")
        rough = _BINS[self._spectra[0].argmax()]
        near = np.abs(_BINS - rough) <= _HALF_WIDTH
        return float(60 * _BINS[np.where(near, self._spectra[1], 0).argmax()])
