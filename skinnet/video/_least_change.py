"""The smallest change of blood that a single frame tells from none."""

import numpy as np
from numpy.typing import NDArray

from skinnet.video._readings import QUANTILE, Reading
from skinnet.video._regions import FACE, NAMES

_MUCH, UNREADABLE = 0.12, 0.5
"""The smallest relative changes that can be told from none from which on that is said, and from
which on the face counts as unreadable."""


class LeastChange:
    """Pools the noise of all readings of a video; its memory does not grow."""

    def __init__(self) -> None:
        self._squares, self._counts = np.zeros(len(NAMES)), np.zeros(len(NAMES), int)

    def add(self, reading: Reading) -> None:
        """Add a reading."""
        if reading.noise_sd is not None:
            seen = np.isfinite(reading.noise_sd)
            self._squares += np.where(seen, reading.noise_sd, 0.0) ** 2
            self._counts += seen

    def describe(self) -> dict[str, float | None]:
        """The relative change of each region (90 %), for JSON; None if it was never seen."""
        return {
            name: round(float(one), 4) if seen else None
            for name, one, seen in zip(NAMES, self._find(), self._counts, strict=True)
        }

    def list_notes(self) -> list[str]:
        """Sentences on a face of which single frames tell little."""
        percent = 100 * float(self._find()[NAMES.index(FACE)])
        why = "its skin is dark, its light changes, or the video is compressed strongly."
        if percent > 100 * UNREADABLE:
            return [
                "Changes of blood cannot be read in this face: in single frames, only those above "
                f"about {percent:.0f} % can be told from none. {why[0].upper()}{why[1:]}"
            ]
        if percent > 100 * _MUCH:
            return [
                f"In single frames, changes of blood below about {percent:.0f} % cannot be told "
                f"from none in this face: {why}"
            ]
        return []

    def _find(self) -> NDArray[np.float64]:
        spread = np.sqrt(self._squares / np.maximum(self._counts, 1))
        return np.asarray(np.exp(QUANTILE * spread) - 1)
