"""Synthetic sequences of hemoglobin maps whose causes are known."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy import ndimage

from skinnet.appearance import BloodSequence
from skinnet.appearance._blood_change import stretch
from skinnet.appearance._time_course import PULSE, beat, follow

_RATE, _STEP = 70.0, 0.4
"""Pulse in beats per minute, and seconds between frames: no multiple of a beat."""

_SMOOTH_NOISE, _FINE_NOISE = 0.02, 0.02
"""Standard deviations of the errors of log hemoglobin: over 8 texels, and of single texels."""

_HIDDEN_SHARE = 0.04
"""Share of frames in which something covers a part of the face."""

_ACTIVE = 10
"""Causes that act on a frame at once, in the mean."""


class TrueModel(NamedTuple):
    """The truth of the sequences.

    Attributes:
        names: Names of the causes.
        mean: Log change of the local mean by each, [names, size, size].
        spread: Relative change of the local standard deviation by each, [names, size, size].
        seconds: Time constants, [names].
    """

    names: tuple[str, ...]
    mean: Float[np.ndarray, "names size size"]
    spread: Float[np.ndarray, "names size size"]
    seconds: Float[np.ndarray, "names"]


def sample_sequence(
    truth: TrueModel,
    rest: Float[np.ndarray, "size size"],
    frames: int,
    sigma: float,
    rng: np.random.Generator,
) -> BloodSequence:
    """Sample a sequence of a face.

    Args:
        truth: How blood follows its causes.
        rest: Hemoglobin at rest on the chart; NaN where there is no skin.
        frames: Number of frames.
        sigma: Standard deviation of the local window in texels.
        rng: Random numbers.
    """
    times = np.asarray(_STEP * np.arange(frames), np.float64)
    amounts = np.asarray(_sample_amounts(truth.names, frames, rng), np.float64)
    driven = amounts.copy()
    for index, name in enumerate(truth.names):
        if name == PULSE:
            driven[:, index] = amounts[:, index] = amounts[:, index] * beat(times, _RATE)
        else:
            driven[:, index] = follow(amounts[:, index], times, float(truth.seconds[index]))
    skin = np.isfinite(rest)
    filled = np.where(skin, rest, 0.05).astype(np.float32)
    maps = []
    for row in driven:
        mean, spread = (np.tensordot(row, each, 1) for each in (truth.mean, truth.spread))
        blood = stretch(filled, mean, spread, skin.astype(np.float32), sigma, 1.0)
        maps.append(np.where(skin, blood * _sample_noise(rest.shape, rng), np.nan))
    stacked = _hide_parts(np.stack(maps), rng)
    return BloodSequence(rest, stacked, times, dict(zip(truth.names, amounts.T, strict=True)))


def _sample_amounts(
    names: Sequence[str], frames: int, rng: np.random.Generator
) -> Float[np.ndarray, "frames names"]:
    """Amounts that begin and end at random times, smoothly."""
    amounts = np.zeros((frames, len(names)))
    share = _ACTIVE / len(names)
    for column in amounts.T:
        begin = rng.integers(1, frames, rng.poisson(share * 4))
        for start in begin.tolist():
            column[start : start + int(rng.integers(6, frames // 3))] = rng.uniform(0.3, 1)
    smooth: Float[np.ndarray, "frames names"] = ndimage.gaussian_filter1d(amounts, 1.0, axis=0)
    return smooth


def _sample_noise(
    shape: tuple[int, ...], rng: np.random.Generator
) -> Float[np.ndarray, "size size"]:
    fine, rough = rng.standard_normal((2, *shape))
    smooth = ndimage.gaussian_filter(rough, 8.0)
    noise = _FINE_NOISE * fine + _SMOOTH_NOISE * smooth / max(float(smooth.std()), 1e-9)
    return np.asarray(np.exp(noise))


def _hide_parts(
    maps: Float[np.ndarray, "frames size size"], rng: np.random.Generator
) -> Float[np.ndarray, "frames size size"]:
    """Give a disc of some frames wrong values, as a hand does that is taken for the face."""
    size = maps.shape[-1]
    rows, columns = np.ogrid[:size, :size]
    for one in maps:
        if rng.random() < _HIDDEN_SHARE:
            row, column, radius = rng.uniform(0.2, 0.8, 3) * (size, size, size / 4)
            disc = (rows - row) ** 2 + (columns - column) ** 2 < radius**2
            one[disc] *= np.exp(rng.normal(0, 0.5))
    return maps
