"""A face in a video, followed frame by frame."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, NoFaceError
from skinnet.images._arguments import check_photo
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.inference.decomposer import Decomposer
from skinnet.video._events import Event, EventFinder
from skinnet.video._face_follower import FaceChoice, FaceFollower, Followed
from skinnet.video._frame_colours import FrameColours
from skinnet.video._least_change import LeastChange
from skinnet.video._look_series import PooledMelanin, describe_constancy
from skinnet.video._pulse import PulseEstimate, PulseMeter, PulseSummary
from skinnet.video._readings import LOST, READ, Reading, make_blank
from skinnet.video._regions import NAMES
from skinnet.video._shot import Shot
from skinnet.video._trace import Trace
from skinnet.video.track import Track, _summarise_regions

_BASELINE, _LOOKS = (0.0, 3.0), 5
"""Seconds of the baseline, and frames of it that the network reads."""

_MOST_LOST = 2.0
"""Seconds without a face after which the pulse begins anew."""

_MOST_LISTED = 1000
"""Events and shots that are listed at most."""


class Tracker:
    """Reads hemoglobin of a face over time, fed frame by frame; its memory does not grow.

    Light, camera and white balance hold through a shot, and melanin does not change within minutes.
    So the resting maps are read once, from some frames of the baseline, and each frame is compared
    with the baseline: gains and white balance cancel in log ratios of colours. Melanin is one
    number, pooled from more looks through the whole video. The skin model says
    how colours answer to blood at the resting maps; what all channels share is light, exposure and
    shading, and what is white is gloss.

    Args:
        decomposer: Reads the face at rest; None for one with the shipped model.
        face: Which face: its number from left to right, or "largest"; None if there is to be one.
        baseline: First and last second of the baseline, from the start of each shot.
        looks: Frames of the baseline that the network reads, 1 or more.
        capture: What is known of the light and the camera: a `Capture`, or a `CaptureProfile`,
            whose tone curve is undone.
        maps: Whether readings have a map of the face.

    Attributes:
        pulse: The last estimate of the pulse; None before the first.

    Raises:
        InputError: An argument is none of those.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.video import Tracker
        >>> tracker = Tracker(baseline=(0, 0.1), maps=False)
        >>> for number in range(5):
        ...     readings = tracker.add(astronaut()[:256, 100:356], number / 30)
        >>> abs(float(readings[-1].change[0])) < 0.05
        True
    """

    def __init__(
        self,
        decomposer: Decomposer | None = None,
        *,
        face: FaceChoice = None,
        baseline: Sequence[int | float] = _BASELINE,
        looks: int = _LOOKS,
        capture: Any = None,
        maps: bool = True,
    ) -> None:
        self._decomposer = decomposer or Decomposer()
        self._baseline = _check_baseline(baseline)
        self._looks, self._capture, self._maps = looks, capture, maps
        if looks < 1:
            raise InputError(f"looks is the number of frames that are read, from 1; got {looks}.")
        tone = capture.tone if isinstance(capture, CaptureProfile) else None
        self._colours = FrameColours(tone)
        self._follower = FaceFollower(_check_face(face))
        self._meter, self._summary = PulseMeter(), PulseSummary()
        self.pulse: PulseEstimate | None = None
        self._finders = [EventFinder(name) for name in NAMES]
        self._events: list[Event] = []
        self._shots: list[dict[str, Any]] = []
        self._refusal: InputError | None = None
        self._rest: list[tuple[NDArray[np.float64], ...]] = []
        self._melanin: list[tuple[int, PooledMelanin]] = []
        self._trace = Trace(1 + 2 * len(NAMES))
        self._least = LeastChange()
        self._frames = dict.fromkeys((READ, LOST, "hidden"), 0)
        self._notes: dict[str, None] = {}
        self._shot: Shot | None = None
        self._number, self._first, self._last = 0, np.nan, -np.inf
        self._seen = -np.inf
        self._peak_size = 0.0
        self._portraits: tuple[NDArray[np.uint8] | None, NDArray[np.float32] | None] = (None, None)
        self.waiting: list[Reading] = []
        self._peak: tuple[float, NDArray[np.float32]] | None = None

    def add(self, frame: NDArray[np.uint8], time: float) -> list[Reading]:
        """Add the next frame.

        Args:
            frame: uint8 sRGB [H, W, 3], upright.
            time: Its time stamp in seconds; larger than that of the frame before.

        Returns:
            The readings that are ready: none in a baseline, all of it at its end, then one a frame.

        Raises:
            InputError: The frame or the time cannot be used, there are several faces and none was
                chosen, or the face cannot be read.
        """
        check_photo(frame)
        if not np.isfinite(time) or time <= self._last:
            raise InputError(
                f"Time stamps are seconds that increase; got {time:g} after {self._last:g}."
            )
        self._first = time if np.isnan(self._first) else self._first
        self._last = time
        followed = self._follower.follow(frame, time)
        readings = self._cut(time) if followed.is_cut else []
        readings += self._add(frame, time, followed)
        self._number += 1
        for reading in readings:
            self._take(reading)
        return readings

    def finish(self) -> Track:
        """Finish, and summarise. Frames that waited for the end of a baseline are in `waiting`.

        Returns:
            What was read of the face.

        Raises:
            NoFaceError: No frame shows a face.
        """
        self.waiting = self._close_shot()
        for reading in self.waiting:
            self._take(reading)
        if not self._rest and self._refusal is not None:
            raise self._refusal
        if not self._rest:
            raise NoFaceError(
                f"No face was found in the {self._number} frames of the video."
                if self._number
                else "The video has no frames."
            )
        for finder in self._finders:
            if (last := finder.restart(0)) is not None:
                self._keep_event(last)
        return self._summarise()

    def _add(self, frame: NDArray[np.uint8], time: float, followed: Followed) -> list[Reading]:
        if self._shot is None:
            if followed.landmarks is None:
                shot = len(self._shots) + 1
                return [make_blank(self._number, time, shot, LOST, len(NAMES))]
            self._shot = self._open_shot(time)
        readings = self._shot.add(self._number, time, frame, followed)
        if self._shot.is_refused and self._shot.refusal is not None and not self._rest:
            raise self._shot.refusal
        return readings

    def _open_shot(self, time: float) -> Shot:
        number = len(self._shots) + 1
        for finder in self._finders:
            if (last := finder.restart(number)) is not None:
                self._keep_event(last)
        return Shot(
            self._decomposer,
            number,
            time,
            self._baseline,
            self._looks,
            self._colours,
            self._capture,
            self._maps,
        )

    def _cut(self, time: float) -> list[Reading]:
        """End the shot at a cut: another light and white balance may begin."""
        waiting = self._close_shot()
        self._meter.clear()
        self._note(
            f"There is a cut at {time:.2f} s: what follows is a shot with a baseline of its own."
        )
        return waiting

    def _close_shot(self) -> list[Reading]:
        if self._shot is None:
            return []
        shot, waiting = self._shot, self._shot.finish()
        self._keep_shot(shot)
        self._shot = None
        return waiting

    def _keep_shot(self, shot: Shot) -> None:
        if shot.rest is None:
            refusal = shot.refusal or self._explain_baseline(shot)
            self._refusal = self._refusal or refusal
            if refusal is not None:
                self._note(f"The shot from {shot.start:.2f} s is not read: {refusal}")
            return
        self._check_baseline_end(shot)
        for sentence in shot.notes:
            self._note(sentence)
        if len(self._shots) < _MOST_LISTED:
            self._shots.append(
                {
                    "number": shot.number,
                    "start": round(shot.start, 3),
                    "end": round(self._last, 3),
                    "baseline": [round(shot.start + each, 3) for each in self._baseline],
                    "looks": shot.rest.looks,
                }
            )
            pooled = shot.pool_melanin()
            self._melanin.append((shot.number, pooled._replace(texels=pooled.texels[:0])))
            self._rest.append((*shot.average_melanin(pooled), *shot.resting_blood()))
            self._portraits = (shot.portrait, shot.space.fill(shot.rest.hemoglobin))

    def _explain_baseline(self, shot: Shot) -> InputError | None:
        """Say that a shot ends before its baseline begins, if it does."""
        begin, length = self._baseline[0], self._last - shot.start
        if length >= begin:
            return None
        return InputError(
            f"The baseline begins at {begin:g} s, and the shot is {length:.2f} s long; give an "
            "earlier baseline."
        )

    def _check_baseline_end(self, shot: Shot) -> None:
        end, length = self._baseline[1], self._last - shot.start
        if length <= end:
            self._note(
                f"The shot from {shot.start:.2f} s is {length:.2f} s long, and its baseline "
                f"{end:g} s: it is compared with itself. Give a shorter baseline to see changes."
            )

    def _take(self, reading: Reading) -> None:
        """Count a reading, and pass it on to pulse and events."""
        self._frames[reading.state] += 1
        row = np.concatenate([[reading.time], reading.change, reading.change_sd])
        self._trace.add(row)
        if reading.state != READ:
            return
        if reading.time - self._seen > _MOST_LOST:
            self._meter.clear()
        self._seen = reading.time
        self._least.add(reading)
        self._take_events(reading)
        if reading.direction is not None:
            found = self._meter.add(reading.time, reading.ratios, reading.direction)
            if found is not None:
                self.pulse = found
                self._summary.add(found)
        self._keep_peak(reading)

    def _take_events(self, reading: Reading) -> None:
        for index, finder in enumerate(self._finders):
            change, sd = float(reading.change[index]), float(reading.change_sd[index])
            noise = sd if reading.noise_sd is None else float(reading.noise_sd[index])
            found = finder.add(reading.time, change, sd, noise)
            if found is not None:
                self._keep_event(found)

    def _keep_event(self, event: Event) -> None:
        if len(self._events) < _MOST_LISTED:
            self._events.append(event)

    def _keep_peak(self, reading: Reading) -> None:
        size = abs(float(reading.change[0]))
        if reading.texture is not None and (self._peak is None or size > self._peak_size):
            self._peak, self._peak_size = (reading.time, reading.texture), size

    def _note(self, sentence: str) -> None:
        if len(self._notes) < _MOST_LISTED:
            self._notes[sentence] = None

    def _summarise(self) -> Track:
        rest = np.array(self._rest)  # [shots, 4, regions]
        info = self._decomposer.encoder.output_info
        melanin, melanin_sd = np.exp(_take_median(np.log(rest[:, 0]))), _take_median(rest[:, 1])
        lost = self._frames[LOST]
        if lost:
            self._note(f"{lost} of {sum(self._frames.values())} frames show no face.")
        for sentence in self._least.list_notes():
            self._note(sentence)
        return Track(
            _summarise_regions(melanin, melanin_sd, info["melanin"].range[1]),
            _summarise_regions(rest[0, 2], rest[0, 3], info["hemoglobin"].range[1]),
            self._summary.describe(),
            tuple(sorted(self._events, key=lambda event: event.onset)),
            tuple(self._shots),
            dict(self._frames),
            float(self._last - self._first),
            tuple(self._notes),
            self._decomposer.encoder.describe(),
            describe_constancy(self._melanin),
            self._least.describe(),
            self._trace.rows(),
            self._portraits[0],
            self._peak,
            self._portraits[1],
        )


def _take_median(shots: NDArray[np.float64]) -> NDArray[np.float64]:
    """Median over shots [shots, regions]; NaN for regions that no shot shows."""
    seen = np.isfinite(shots).any(0)
    median = np.full(shots.shape[1], np.nan)
    median[seen] = np.nanmedian(shots[:, seen], 0)
    return median


def _check_baseline(baseline: Sequence[int | float]) -> tuple[float, float]:
    begin, end = (float(each) for each in baseline)
    if not 0 <= begin < end < np.inf:
        raise InputError(
            "baseline is its first and last second from the start of a shot, such as (0, 3); got "
            f"({begin:g}, {end:g})."
        )
    return begin, end


def _check_face(face: FaceChoice) -> FaceChoice:
    is_number = isinstance(face, int) and not isinstance(face, bool) and face >= 1
    if face is not None and face != "largest" and not is_number:
        raise InputError(f"face is a number from 1, or largest; got {face!r:.60}.")
    return face
