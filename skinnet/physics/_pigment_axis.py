"""The axis of a pigment table: nodes at equal steps of log(1 + f / spacing)."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float


class PigmentAxis(NamedTuple):
    """Nodes of a volume fraction f from `low` to `high`, at equal steps of log(1 + f / spacing).

    `spacing` is about the fraction that absorbs half of the light: nodes are evenly spaced below
    it, and have a constant ratio above it. A position counts nodes from the first and need not be
    a whole number.
    """

    low: float
    high: float
    nodes: int
    spacing: float

    @property
    def step(self) -> float:
        """Difference of log(1 + f / spacing) between two nodes."""
        low, high = (math.log1p(end / self.spacing) for end in (self.low, self.high))
        return (high - low) / (self.nodes - 1)

    @property
    def scale_and_shift(self) -> tuple[float, float]:
        """Scale and shift in position = scale * log(f + spacing) + shift.

        A caller can combine them with its own linear map, so that it passes over a map only once.
        """
        scale = 1 / self.step
        return scale, -math.log(self.low + self.spacing) * scale

    def fractions(self, position: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        """Fractions at positions, in the precision of `position`; at its ends the range's own."""
        fraction = self.spacing * np.expm1(
            math.log1p(self.low / self.spacing) + self.step * position
        )
        # Rounding would put a position on the border just inside the range.
        fraction = np.where(position > 0, fraction, self.low)
        fraction = np.where(position < self.nodes - 1, fraction, self.high)
        return fraction.clip(self.low, self.high).astype(position.dtype)
