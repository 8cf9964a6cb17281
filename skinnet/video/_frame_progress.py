"""How far a run over the frames of a video is, with the time that is left."""

import sys
import time
from types import TracebackType
from typing import Any

from skinnet.inference._messages import Verbosity, get_verbosity, note
from skinnet.inference._progress import _EVERY, _is_terminal

_REDRAW = 0.5
"""Seconds between two drawings of the line on a terminal."""


class FrameProgress:
    """A line on a terminal, else a line a minute.

    Args:
        duration: Length of the video in seconds; None if it is not known.
        quiet: Whether to say nothing.
    """

    def __init__(self, duration: float | None, quiet: bool = False) -> None:
        self._duration, self._count = duration, 0
        self._is_silent = quiet or get_verbosity() < Verbosity.USUAL
        self._terminal: Any = sys.stderr if _is_terminal(sys.stderr) else None
        self._start = self._last = time.monotonic()
        self._width = 0

    def __enter__(self) -> "FrameProgress":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._width:
            self._terminal.write("\r" + " " * self._width + "\r")

    def advance(self, seconds: float) -> None:
        """Say that a frame at a time of the video is done."""
        self._count += 1
        now = time.monotonic()
        if self._is_silent or now - self._last < (_EVERY if self._terminal is None else _REDRAW):
            return
        self._last = now
        line = self._describe(seconds, now - self._start)
        if self._terminal is None:
            note(line)
        else:
            self._terminal.write("\r" + line.ljust(self._width))
            self._terminal.flush()
            self._width = max(self._width, len(line))

    def _describe(self, seconds: float, spent: float) -> str:
        rate = self._count / max(spent, 1e-6)
        if not self._duration or seconds <= 0:
            return f"{seconds:.0f} s read, {rate:.1f} frames a second."
        left = max(spent * (self._duration / seconds - 1), 0.0)
        return (
            f"{seconds:.0f} of {self._duration:.0f} s read, {rate:.1f} frames a second, about "
            f"{int(left) // 60}:{int(left) % 60:02d} left."
        )
