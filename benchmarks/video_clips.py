"""One synthetic clip, rendered, compressed, tracked and compared with its truth."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.pulse_baselines import METHODS, estimate_pulse
from benchmarks.video_peers import PulsePeer
from skinnet.errors import InputError
from skinnet.inference import Decomposer
from skinnet.inference.indices import compute_indices
from skinnet.video import Track, Tracker
from skinnet.video._readings import Reading
from skinnet.video._regions import FACE, NAMES
from skinnet.video._video_frames import Frame, VideoFrames
from train.synthetic.faces import SyntheticFaces
from train.synthetic.videos.clip_files import ClipWriter, write_clip
from train.synthetic.videos.clips import ClipPlan, Clips

Array = NDArray[np.float64]

_BASELINE = 0.0, 3.0
"""First and last second of the baseline."""

LIGHT, DARK = 41.0, 10.0
"""Typology angles, in degrees, above which a tone is light, and below which it is dark."""

_STRONG, _EVERY = 21, 4
"""Rate factor of a second, strong compression, .01 to .03 bits a pixel, and of how many clips one
is read so, too."""


class ClipScore(NamedTuple):
    """A clip and what was read of it.

    Attributes:
        plan: What was sampled.
        tone: light, medium or dark.
        truth: True log ratios to the baseline, [frames, regions].
        change: Those that were read; NaN where they were not.
        sd: Their standard deviations.
        pulse: Beats per minute by method; None where there is none.
        is_readable: Whether the tracker calls its pulse readable.
        onset: Where the first event of the face of the true kind begins; None if none is found.
        false_events: Events of the face of another kind than the true one.
        melanin: Mean melanin that is read of the clip, and of its second half alone.
        bits: Bits a pixel of the video file.
        constancy: How constant melanin is, as the tracker describes it.
        strong: The same clip compressed strongly; None for most.
    """

    plan: ClipPlan
    tone: str
    truth: Array
    change: Array
    sd: Array
    pulse: dict[str, float | None]
    is_readable: bool
    onset: float | None
    false_events: int
    melanin: tuple[float, float | None]
    bits: float
    constancy: Mapping[str, Any] = {}
    strong: "StrongScore | None" = None


class StrongScore(NamedTuple):
    """What was read of a clip that is compressed strongly.

    Attributes:
        bits: Bits a pixel of the video file.
        truth: True log ratios to the baseline, [frames, regions].
        change: Those that were read.
        sd: Their standard deviations.
    """

    bits: float
    truth: Array
    change: Array
    sd: Array


def score_clip(
    clips: Clips,
    data: SyntheticFaces,
    number: int,
    decomposer: Decomposer,
    peers: Sequence[PulsePeer] = (),
) -> ClipScore | None:
    """Score a clip; None if the tracker refuses it."""
    plan = clips.plan(number)
    renderer = clips.make_renderer(data, plan)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "clip.mp4"
        write_clip(path, renderer, plan.quality)
        frames, bits = _read(path)
        whole = np.stack([renderer.true_change(time) for time in renderer.times.tolist()])
        strong = None
        if number % _EVERY == 0:
            _compress(path, frames)
            strong = _score_strong(decomposer, *_read(path), whole)
    try:
        track, readings, rate = follow(decomposer, frames)
    except InputError:
        return None
    truth = _subtract_baseline(whole, readings)
    events = [one for one in track.events if one.region == FACE]
    right = [one.onset for one in events if one.kind == plan.course.kind]
    return ClipScore(
        plan,
        find_tone(plan.melanin, float(renderer.resting_hemoglobin)),
        truth,
        np.stack([one.change for one in readings]),
        np.stack([one.change_sd for one in readings]),
        _find_pulses(rate, readings) | {one.name: one(frames) for one in peers},
        bool(track.pulse["is_readable"]),
        right[0] if right else None,
        len(events) - len(right),
        (float(track.melanin[FACE]["mean"]), _read_again(decomposer, frames)),
        bits,
        track.constancy,
        strong,
    )


def _read(path: Path) -> tuple[list[Frame], float]:
    """Frames of a video file, and its bits a pixel."""
    video = VideoFrames(path, path.name)
    frames = list(video)
    return frames, float(video.bits_per_pixel or 0.0)


def _compress(path: Path, frames: Sequence[Frame]) -> None:
    writer = ClipWriter(path, _STRONG)
    for frame in frames:
        writer.add(frame.pixels, frame.time)
    writer.close()


def _score_strong(
    decomposer: Decomposer, frames: list[Frame], bits: float, whole: Array
) -> StrongScore | None:
    try:
        _, readings, _ = follow(decomposer, frames)
    except InputError:
        return None
    change, sd = (np.stack([getattr(one, name) for one in readings])
                  for name in ("change", "change_sd"))  # fmt: skip
    return StrongScore(bits, _subtract_baseline(whole, readings), change, sd)


def _subtract_baseline(whole: Array, readings: Sequence[Reading]) -> Array:
    """True log ratios to the baseline."""
    times = np.array([one.time for one in readings])
    truth = whole[: len(readings)]
    return np.asarray(truth - truth[times <= _BASELINE[1]].mean(0))


def follow(
    decomposer: Decomposer, frames: list[Frame], baseline: tuple[float, float] = _BASELINE
) -> tuple[Track, list[Reading], float]:
    """Track frames. Returns the summary, all readings, and the pulse, readable or not."""
    tracker, readings = Tracker(decomposer, baseline=baseline, maps=False), []
    for frame in frames:
        readings += tracker.add(frame.pixels, frame.time)
    track = tracker.finish()
    return track, readings + tracker.waiting, tracker._summary.find_rate()


def find_tone(melanin: float, hemoglobin: float) -> str:
    """Name the tone of skin with these fractions, by its typology angle."""
    angle = compute_indices(melanin, hemoglobin).typology_angle
    degrees = angle.value
    return "light" if degrees > LIGHT else "dark" if degrees < DARK else "medium"


def _find_pulses(rate: float, readings: list[Reading]) -> dict[str, float | None]:
    face = NAMES.index(FACE)
    rows = [(one.time, *one.ratios[face]) for one in readings if one.state == "read"]
    values = np.array(rows)
    pulses: dict[str, float | None] = {"skinnet": rate if np.isfinite(rate) else None}
    for name, method in METHODS.items():
        pulses[name] = estimate_pulse(values[:, 0], values[:, 1:], method)
    return pulses


def _read_again(decomposer: Decomposer, frames: list[Frame]) -> float | None:
    """Melanin of the second half of a clip, read as a video of its own."""
    try:
        track, _, _ = follow(decomposer, frames[len(frames) // 2 :])
    except InputError:
        return None
    return float(track.melanin[FACE]["mean"])
