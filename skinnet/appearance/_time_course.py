"""How blood follows its causes in time: with a lag, and with each beat of the heart."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

PULSE = "pulse"
"""The coefficient that the heart drives: its amount is the pulse's strength."""

LAGS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Time constants in seconds that a fit tries."""

_SAMPLES = 200

Array = NDArray[np.float64]


def respond(amount: float, seconds: float, time: int | float) -> float:
    """The amount after a time in seconds, for a cause that has begun at 0 and stays."""
    return amount if seconds <= 0 else amount * float(-np.expm1(-max(time, 0.0) / seconds))


def follow(amounts: Array, times: Array, seconds: float) -> Array:
    """The response of first order to amounts [frames] at times [frames] in seconds.

    It is exact for a cause that is constant between frames, and begins in equilibrium.
    """
    if seconds <= 0:
        return amounts.copy()
    response = np.empty(len(amounts))
    response[:1] = amounts[:1]
    keep = np.exp(-np.diff(times) / seconds)
    for frame, share in enumerate(keep.tolist(), 1):
        response[frame] = share * response[frame - 1] + (1 - share) * amounts[frame]
    return response


def beat(times: Array | int | float, rate: int | float) -> Array:
    """The pulse wave at times in seconds, for a rate in beats per minute: 0 to 1, and 1 its peak.

    Source:
        Q. Tang et al., Synthetic photoplethysmogram generation using two Gaussian functions,
        Scientific Reports 10, 2020: the systolic wave and its reflection, of an excellent signal.
    """
    wave = _sample_beat()
    place = np.asarray(times, np.float64) * rate / 60 % 1
    return np.asarray(np.interp(place, np.linspace(0, 1, len(wave)), wave))


@cache
def _sample_beat() -> Array:
    place = np.linspace(0, 1, _SAMPLES)
    wave = np.exp(-(((place - 0.30) / 0.12) ** 2)) + 0.55 * np.exp(-(((place - 0.62) / 0.16) ** 2))
    closed = wave - np.linspace(0, wave[-1] - wave[0], _SAMPLES)
    return np.asarray((closed - closed.min()) / np.ptp(closed))
