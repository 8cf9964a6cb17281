"""How blood in a face changes over time: pulse, flush and blanching."""

import csv
import itertools
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

PPG = Path(__file__).parents[4] / "shared" / "data" / "ppg"
"""Folder of measured pulse waves, if it is there: examples of vitallens-python (Rouast Labs, MIT),
sampled with the frames of their video, 30 a second."""

_MEASURED_RATE = 30.0
_LEAST_BEAT = 0.4

EventKind = Literal["flush", "blanching", "none"]

Times = Float[np.ndarray, "frames"]


@dataclass(frozen=True)
class BloodCourse:
    """The course of one clip.

    Attributes:
        rate: Pulse in beats per minute.
        variability: Relative amplitude of the slow change of the rate with breathing.
        pulse: Peak-to-peak log change of hemoglobin with each beat.
        kind: Which event there is.
        onset: When it begins, in seconds.
        rise: Seconds until it is complete.
        size: Its log change of hemoglobin where it is strongest, above 0.
        is_measured: Whether beats have the shape of a measured wave.
        phase: Phase of the first beat, in beats.
    """

    rate: float
    variability: float
    pulse: float
    kind: EventKind
    onset: float
    rise: float
    size: float
    is_measured: bool
    phase: float = 0.0

    def beats(self, times: Times) -> Times:
        """Return the log change by the pulse, with mean 0 over a beat and a range of `pulse`."""
        breath = 2 * np.pi * 0.25
        wave = self.variability * self.rate / 60 / breath * np.sin(breath * times)
        place = (self.phase + self.rate / 60 * times + wave) % 1
        shape = _measured_beat() if self.is_measured and PPG.is_dir() else _model_beat()
        return np.asarray(self.pulse * np.interp(place, np.linspace(0, 1, len(shape)), shape))

    def event(self, times: Times) -> Times:
        """Return the log change by the event, where it is strongest: a smooth ramp that stays."""
        sign = {"flush": 1.0, "blanching": -1.0, "none": 0.0}[self.kind]
        share = np.clip((times - self.onset) / self.rise, 0, 1)
        return np.asarray(sign * self.size * share**2 * (3 - 2 * share))


def sample_course(rng: np.random.Generator, number: int, seconds: float) -> BloodCourse:
    """Sample the course of a clip; one in three has a flush, one blanching, one none.

    The pulse changes hemoglobin by 2 to 5 %, which changes green light by .4 to 1 %, peak to peak:
    0.5 to 2 % is what Verkruysse et al. (Optics Express 16, 2008) and others saw in faces.
    """
    kinds: tuple[EventKind, ...] = ("flush", "blanching", "none")
    kind = kinds[number // 3 % 3]
    return BloodCourse(
        rate=float(rng.uniform(50, 115)),
        variability=float(rng.uniform(0, 0.03)),
        pulse=float(rng.uniform(0.02, 0.05)),
        kind=kind,
        onset=float(rng.uniform(0.3, 0.45) * seconds),
        rise=float(rng.uniform(0.12, 0.3) * seconds),
        size=float(rng.uniform(0.2, 0.6) if kind == "flush" else rng.uniform(0.15, 0.4)),
        is_measured=bool(number % 2),
        phase=float(rng.random()),
    )


def find_spread(
    azimuth: Float[np.ndarray, "h w"], elevation: Float[np.ndarray, "h w"]
) -> tuple[Float[np.ndarray, "h w"], Float[np.ndarray, "h w"]]:
    """How strong an event and the pulse are over a face, by azimuth and elevation in radians.

    Cheeks flush most, as in the maps of Jimenez et al. (2010); the pulse is strongest in forehead
    and cheeks.
    """
    cheeks = np.exp(-(((np.abs(azimuth) - 0.55) / 0.28) ** 2) - ((elevation + 0.15) / 0.3) ** 2)
    brow = np.exp(-((azimuth / 0.6) ** 2) - ((elevation - 0.5) / 0.3) ** 2)
    return 0.45 + 0.55 * cheeks, 0.7 + 0.3 * np.maximum(cheeks, brow)


@cache
def _model_beat() -> Float[np.ndarray, "samples"]:
    """One beat of two Gaussians, the systolic wave and its reflection.

    Source:
        Q. Tang et al., Synthetic photoplethysmogram generation using two Gaussian functions,
        Scientific Reports 10, 2020 (the parameters of an excellent signal, in shape).
    """
    place = np.linspace(0, 1, 200)
    beat = np.exp(-(((place - 0.30) / 0.12) ** 2)) + 0.55 * np.exp(-(((place - 0.62) / 0.16) ** 2))
    return _normalise(beat)


@cache
def _measured_beat() -> Float[np.ndarray, "samples"]:
    """The mean beat of a measured wave, between its lowest points."""
    with open(PPG / "vitals_1.csv", newline="", encoding="utf-8") as file:
        wave = np.array([float(row["ppg"]) for row in csv.DictReader(file)])
    gap = int(_LEAST_BEAT * _MEASURED_RATE)
    feet = [
        index
        for index in range(gap, len(wave) - gap)
        if wave[index] == wave[index - gap : index + gap + 1].min()
    ]
    beats = [
        np.interp(np.linspace(a, b, 200), np.arange(len(wave)), wave)
        for a, b in itertools.pairwise(feet)
    ]
    return _normalise(np.median(beats, 0)) if beats else _model_beat()


def _normalise(beat: Float[np.ndarray, "samples"]) -> Float[np.ndarray, "samples"]:
    closed = beat - np.linspace(0, beat[-1] - beat[0], len(beat))
    return np.asarray((closed - closed.mean()) / np.ptp(closed))
