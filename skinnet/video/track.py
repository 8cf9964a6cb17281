"""What was read of a video: melanin, blood at rest, pulse and events."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.inference._decomposition.summary import round_all
from skinnet.inference._uncertainty import summarise_mean
from skinnet.video._events import Event
from skinnet.video._readings import QUANTILE
from skinnet.video._regions import NAMES

_DISCLAIMER = (
    "This is no medical device: it must not be used to diagnose, treat or monitor. It measures "
    "colour, not health."
)

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class Track:
    """Summary of a video that was tracked; single frames are what a `Tracker` returns.

    Attributes:
        melanin: Of the face and each region `mean`, `sd` and 90 % `interval`; it is one number for
            the whole video, pooled from looks all through it.
        resting_hemoglobin: The same of hemoglobin in the baseline.
        pulse: `rate_bpm` (None if it cannot be read), `quality` in [0, 1], `is_readable` and the
            number of `estimates`.
        events: Flushes and blanchings in order of time.
        shots: Of each shot `start`, `end`, `baseline` and `looks` (frames that the network read).
        frames: How many frames were `read`, `lost` and `hidden`.
        seconds: Time from the first frame to the last one.
        notes: Sentences that the user should read.
        model: Version of the encoder, and the preset of the skin's constants.
        constancy: How constant melanin is through the video: the face's `mean` in all `looks`,
            the `spread` of their logarithms, the `standard_error` of the pooled one, and the
            `drift` between both halves.
        least_change: Of the face and each region the smallest relative change of hemoglobin that a
            single frame tells from none, with 90 % confidence; None where the region is hidden.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.video import Tracker
        >>> tracker = Tracker(baseline=(0, 0.2), maps=False)
        >>> for number in range(8):
        ...     readings = tracker.add(astronaut()[:256, 100:356], number / 30)
        >>> track = tracker.finish()
        >>> track.frames["read"]
        8
        >>> low, high = track.melanin["face"]["interval"]
        >>> low < track.melanin["face"]["mean"] < high
        True
    """

    melanin: dict[str, dict[str, Any]]
    resting_hemoglobin: dict[str, dict[str, Any]]
    pulse: dict[str, Any]
    events: tuple[Event, ...]
    shots: tuple[dict[str, Any], ...]
    frames: dict[str, int]
    seconds: float
    notes: tuple[str, ...]
    model: dict[str, str]
    constancy: dict[str, Any] = field(default_factory=dict)
    least_change: dict[str, float | None] = field(default_factory=dict)
    _trace: Array = field(default_factory=lambda: np.zeros((0, 0)))
    _portrait: NDArray[np.uint8] | None = None
    _peak: tuple[float, NDArray[np.float32]] | None = None
    _resting: NDArray[np.float32] | None = None

    def __repr__(self) -> str:
        rate = self.pulse["rate_bpm"]
        pulse = f"pulse {rate:.0f}" if rate else "no clear pulse"
        return (
            f"<Track of {self.seconds:.1f} s, {sum(self.frames.values())} frames: {pulse}, "
            f"{len(self.events)} events>"
        )

    def to_dict(self) -> dict[str, Any]:
        """Summarise it in plain types for JSON.

        Returns:
            The attributes, `events` with a `factor` of hemoglobin beside its logarithm, `version`
            and `disclaimer`.

        Example:
            >>> from skinnet.video import Track
            >>> blank = Track({}, {}, {"rate_bpm": None}, (), (), {"read": 0}, 0.0, (), {})
            >>> sorted(blank.to_dict())[:3]
            ['disclaimer', 'events', 'frames']
        """
        return {
            "seconds": round(self.seconds, 3),
            "frames": self.frames,
            "shots": list(self.shots),
            "melanin": self.melanin,
            "melanin_constancy": self.constancy,
            "least_change": self.least_change,
            "resting_hemoglobin": self.resting_hemoglobin,
            "pulse": self.pulse,
            "events": [_describe_event(event) for event in self.events],
            "notes": list(self.notes),
            "version": __version__,
            "model": self.model,
            "disclaimer": _DISCLAIMER,
        }

    def draw(self) -> NDArray[np.uint8]:
        """Draw the panel: the face, its map at rest and at the largest change, and the course.

        Returns:
            uint8 sRGB [H, W, 3].
        """
        from skinnet.video._track_panel import draw_track

        return draw_track(self)


def _describe_event(event: Event) -> dict[str, Any]:
    numbers = {
        "onset": event.onset,
        "peak": event.peak,
        "end": event.end,
        "log_ratio": event.log_ratio,
        "sd": event.sd,
        "factor": float(np.exp(event.log_ratio)),
        "interval": [float(np.exp(event.log_ratio + way * QUANTILE * event.sd)) for way in (-1, 1)],
    }
    what = {"kind": event.kind, "region": event.region, "shot": event.shot}
    return {**what, **round_all(numbers)}


def _summarise_regions(means: Array, log_sds: Array, top: float) -> dict[str, dict[str, Any]]:
    """Summarise fractions of the regions, NaN where they are hidden, for JSON."""
    return {
        name: round_all(summarise_mean(float(mean) if np.isfinite(mean) else None, float(sd), top))
        for name, mean, sd in zip(NAMES, means, log_sds, strict=True)
    }
