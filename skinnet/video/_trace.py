"""A time series that is kept ever more coarsely, so that its memory does not grow."""

import numpy as np
from numpy.typing import NDArray

MOST = 1024
"""Rows that are kept at most."""

Array = NDArray[np.float64]


class Trace:
    """Means of columns over even numbers of successive rows.

    Args:
        columns: Number of columns; the first is the time.
    """

    def __init__(self, columns: int) -> None:
        self._rows = np.full((MOST, columns), np.nan)
        self._count, self._per_row = 0, 1
        self._sum, self._seen, self._waiting = np.zeros(columns), np.zeros(columns), 0

    def add(self, row: Array) -> None:
        """Add a row [columns]; NaN is left out of means."""
        seen = np.isfinite(row)
        self._sum += np.where(seen, row, 0)
        self._seen += seen
        self._waiting += 1
        if self._waiting == self._per_row:
            self._store()

    def rows(self) -> Array:
        """Return the rows so far, [rows, columns]; NaN where nothing was seen."""
        return self._rows[: self._count].copy()

    def _store(self) -> None:
        if self._count == MOST:
            self._halve()
        with np.errstate(invalid="ignore"):
            self._rows[self._count] = self._sum / np.where(self._seen > 0, self._seen, np.nan)
        self._count += 1
        self._sum, self._seen = np.zeros_like(self._sum), np.zeros_like(self._seen)
        self._waiting = 0

    def _halve(self) -> None:
        pairs = self._rows.reshape(MOST // 2, 2, -1)
        seen = np.isfinite(pairs)
        total = np.where(seen, pairs, 0).sum(1)
        self._rows[: MOST // 2] = np.where(seen.any(1), total / np.maximum(seen.sum(1), 1), np.nan)
        self._count, self._per_row = MOST // 2, 2 * self._per_row
