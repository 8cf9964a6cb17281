"""Pulse from the mean colour of skin by published methods, as baselines: green, CHROM and POS."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from skinnet.video._pulse import (
    WINDOW,
    PulseEstimate,
    PulseSummary,
    filter_band,
    find_peak,
    measure_spectrum,
)

Array = NDArray[np.float64]

_RATE, _PIECE = 30.0, 48
"""Samples a second, and samples of a piece of 1.6 s, over which CHROM and POS work."""

_EVERY, _LEAST = 1.0, 6.0


def take_green(colours: Array) -> Array:
    """Green alone, darker with more blood (Verkruysse et al., Optics Express 16, 2008)."""
    return -colours[:, 1] / colours[:, 1].mean()


def project_chrom(colours: Array) -> Array:
    """CHROM (de Haan and Jeanne, IEEE Trans. Biomedical Engineering 60, 2013)."""

    def combine(piece: Array) -> Array:
        red, green, blue = filter_band(piece).T
        x, y = 3 * red - 2 * green, 1.5 * red + green - 1.5 * blue
        return np.asarray(x - x.std() / max(float(y.std()), 1e-12) * y)

    return _overlap(colours, combine)


def project_pos(colours: Array) -> Array:
    """POS (Wang et al., IEEE Trans. Biomedical Engineering 64, 2017)."""

    def combine(piece: Array) -> Array:
        first = piece[:, 1] - piece[:, 2]
        second = piece[:, 1] + piece[:, 2] - 2 * piece[:, 0]
        whole = first + first.std() / max(float(second.std()), 1e-12) * second
        return np.asarray(-(whole - whole.mean()))

    return _overlap(colours, combine)


METHODS: Mapping[str, Callable[[Array], Array]] = {
    "green": take_green,
    "chrom": project_chrom,
    "pos": project_pos,
}


def estimate_pulse(times: Array, ratios: Array, method: Callable[[Array], Array]) -> float | None:
    """Estimate the pulse of a clip in windows and by spectra as `Tracker` does.

    Args:
        times: Seconds, [N].
        ratios: Log ratio of the skin's mean linear RGB to a baseline, [N, 3].
        method: Makes one signal of RGB.

    Returns:
        Beats per minute; None if the clip is too short.
    """
    summary, end = PulseSummary(), times[0] + _LEAST
    while end <= times[-1]:
        chosen = (times <= end) & (times >= end - WINDOW)
        colours = _resample(times[chosen], np.exp(ratios[chosen]))
        signal = filter_band(method(colours)[:, None])[:, 0]
        filled = min((times[chosen][-1] - times[chosen][0]) / WINDOW, 1.0)
        spectra = filled * measure_spectrum(signal)[None].repeat(2, 0)
        summary.add(PulseEstimate(end, *find_peak(signal), spectra))
        end += _EVERY
    rate = summary.find_rate()
    return rate if np.isfinite(rate) else None


def _resample(times: Array, colours: Array) -> Array:
    even = np.arange(times[0], times[-1], 1 / _RATE)
    return np.stack([np.interp(even, times, one) for one in colours.T], -1)


def _overlap(colours: Array, combine: Callable[[Array], Array]) -> Array:
    """Combine the channels of overlapping pieces, each relative to its mean, and add them."""
    whole = np.zeros(len(colours))
    window = np.hanning(_PIECE)
    for start in range(0, len(colours) - _PIECE + 1, _PIECE // 8):
        piece = colours[start : start + _PIECE]
        whole[start : start + _PIECE] += window * combine(piece / piece.mean(0))
    return whole
