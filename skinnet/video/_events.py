"""Events of the blood in a face: flush and blanching, with their size and time."""

from collections import deque
from typing import NamedTuple

import numpy as np

_SMOOTH = 0.7
"""Seconds over which a change is smoothed: a heartbeat is no event."""

_LEAST, _SIGMAS = 0.08, 2.0
"""Least log change of an event, and how many standard deviations of no change it has at least."""

_SUSTAIN, _BACK = 1.5, 20.0
"""Seconds for which an event lasts at least, and over which its begin is looked for."""

_END = 0.5
"""An event is over when the change is back below this part of the least one."""


class Event(NamedTuple):
    """A flush or blanching of a region.

    Attributes:
        kind: flush or blanching.
        region: Where.
        shot: Number of the shot.
        onset: Begin in seconds: where the rise, drawn back in a straight line, leaves 0.
        peak: Time of the largest change.
        end: End in seconds; None if it lasts to the end of the shot.
        log_ratio: Largest log ratio of hemoglobin to the baseline.
        sd: Its standard deviation.
    """

    kind: str
    region: str
    shot: int
    onset: float
    peak: float
    end: float | None
    log_ratio: float
    sd: float


class EventFinder:
    """Finds the events of one region, frame by frame.

    Args:
        region: Its name.
    """

    def __init__(self, region: str) -> None:
        self.region = region
        self.restart(0)

    def restart(self, shot: int) -> Event | None:
        """Begin another shot. Returns the event that lasted to the end of the last one."""
        open_event = self._close(None) if getattr(self, "_event", None) else None
        self._shot, self._smooth, self._time = shot, np.nan, np.nan
        self._trail: deque[tuple[float, float]] = deque()
        self._since: float | None = None
        self._event: Event | None = None
        return open_event

    def add(
        self, time: float, change: float, sd: float, noise: float | None = None
    ) -> Event | None:
        """Add a change with its standard deviation. Returns an event that has ended.

        Args:
            time: Time stamp in seconds.
            change: Log ratio to the baseline.
            sd: Its standard deviation.
            noise: That of no change, without the doubt of a change's size; None: the same.
        """
        if not np.isfinite(change):
            return None
        self._update(time, change)
        least = max(_LEAST, _SIGMAS * (sd if noise is None else noise))
        if self._event is not None:
            return self._go_on(time, sd, least)
        if abs(self._smooth) < least:
            self._since = None
        elif self._since is None:
            self._since = time
        elif time - self._since >= _SUSTAIN:
            kind = "flush" if self._smooth > 0 else "blanching"
            onset = self._find_onset(least)
            self._event = Event(kind, self.region, self._shot, onset, time, None, self._smooth, sd)
        return None

    def _update(self, time: float, change: float) -> None:
        share = 1.0 if np.isnan(self._smooth) else 1 - np.exp(-(time - self._time) / _SMOOTH)
        self._smooth = (
            change if np.isnan(self._smooth) else (self._smooth + share * (change - self._smooth))
        )
        self._time = time
        self._trail.append((time, self._smooth))
        while time - self._trail[0][0] > _BACK or len(self._trail) > 4000:
            self._trail.popleft()

    def _go_on(self, time: float, sd: float, least: float) -> Event | None:
        assert self._event is not None
        sign = 1 if self._event.kind == "flush" else -1
        if sign * self._smooth > sign * self._event.log_ratio:
            self._event = self._event._replace(peak=time, log_ratio=self._smooth, sd=sd)
        if sign * self._smooth > _END * least:
            return None
        return self._close(time)

    def _close(self, end: float | None) -> Event:
        assert self._event is not None
        event, self._event, self._since = self._event._replace(end=end), None, None
        return event

    def _find_onset(self, least: float) -> float:
        """Draw the rise from a half of the least change to all of it back to 0."""
        assert self._since is not None
        half = next(
            (
                time
                for time, value in reversed(self._trail)
                if time < self._since and abs(value) < least / 2
            ),
            self._trail[0][0],
        )
        drawn = half - (self._since - half)
        return float(max(drawn - _SMOOTH, self._trail[0][0]))
