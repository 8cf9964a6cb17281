"""Whether a video shows nothing but one still image."""

import numpy as np
from numpy.typing import NDArray

from skinnet.video._video_frames import Frame

_BLOCK, _MOST_BLOCK, _MOST_MEAN = 8, 4.0, 1.2
"""Side of a block in pixels, and the largest changes of a block's mean and of a pixel on average,
in levels of 255, that compression makes of a still image. A head that is held still changes some
blocks by 20 within a second."""

_LEAST_SECONDS = 1.0
"""Seconds from which on frames that differ so little count as a still image."""


class StillImage:
    """Compares frames with the first one, until one differs."""

    def __init__(self) -> None:
        self._first: Frame | None = None
        self._last = 0.0
        self._is_same = self._is_alike = True

    @property
    def is_still(self) -> bool:
        """Whether no frame differs by more than compression makes of a still image."""
        return self._is_same or (self._is_alike and self._last >= _LEAST_SECONDS)

    def add(self, frame: Frame) -> None:
        """Add the next frame."""
        self._last = frame.time
        if self._first is None:
            self._first = frame
        elif self._is_alike:
            before, now = self._first.pixels, frame.pixels
            self._is_same = self._is_same and bool((before == now).all())
            self._is_alike = self._is_same or _is_alike(before, now)


def _is_alike(before: NDArray[np.uint8], now: NDArray[np.uint8]) -> bool:
    change = now.astype(np.int16) - before
    height, width = (side // _BLOCK * _BLOCK for side in change.shape[:2])
    blocks = change[:height, :width].reshape(height // _BLOCK, _BLOCK, -1, _BLOCK, 3)
    largest = np.abs(blocks.mean((1, 3))).max() if blocks.size else 0.0
    return bool(largest <= _MOST_BLOCK and np.abs(change).mean() <= _MOST_MEAN)
