"""What is read of one frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

READ, LOST, HIDDEN = "read", "lost", "hidden"
"""States of a frame: it is read, no face was found, or too little skin is seen."""

QUANTILE = 1.645
"""Standard deviations from the middle of an interval of 90 % to its ends."""


class Reading(NamedTuple):
    """Hemoglobin of the regions in one frame; NaN where a region cannot be read.

    Attributes:
        number: Number of the frame, from 0.
        time: Time stamp in seconds.
        shot: Number of the shot, from 1; a cut begins another one.
        state: read, lost (no face was found) or hidden (too little skin is seen).
        change: Natural logarithm of hemoglobin over that of the baseline, of `NAMES`, [regions].
        change_sd: Its standard deviation, [regions].
        hemoglobin: Volume fraction of blood in the dermis, [regions].
        log_sd: Standard deviation of its logarithm, [regions].
        gain: Exposure and shading relative to the baseline, [regions].
        ratios: Log ratio of linear RGB to the baseline, [regions, 3].
        texture: Log change over the face's texture, float32 [size, size]; None if not asked for.
        direction: Derivative of log RGB by log hemoglobin at rest, [regions, 3].
        resting: Hemoglobin over the texture at rest, float32 [size, size]; None without `texture`.
        noise_sd: Standard deviation of `change` where it is 0: by noise, gloss and the tone curve,
            without the doubt of its size, [regions].
    """

    number: int
    time: float
    shot: int
    state: str
    change: Array
    change_sd: Array
    hemoglobin: Array
    log_sd: Array
    gain: Array
    ratios: Array
    texture: NDArray[np.float32] | None = None
    direction: Array | None = None
    resting: NDArray[np.float32] | None = None
    noise_sd: Array | None = None


def make_blank(number: int, time: float, shot: int, state: str, regions: int) -> Reading:
    """Make the reading of a frame of which nothing is read."""
    change, change_sd, hemoglobin, log_sd, gain = np.full((5, regions), np.nan)
    ratios = np.full((regions, 3), np.nan)
    return Reading(number, time, shot, state, change, change_sd, hemoglobin, log_sd, gain, ratios)
