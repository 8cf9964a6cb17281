"""A smooth surface of colours through a table, and the foot of a colour on it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

_TO_POWERS = np.array([[0, 1, 0], [-0.5, 0, 0.5], [0.5, -1, 0.5]])
"""Values at -1, 0 and 1 to the parabola through them."""

STEPS, RESTING = 8, 1e-3
"""Most steps to a foot, and the step in nodes that is the last."""

CONVEX = 0.1
"""Share of its value on the surface below which the curvature of the distance is not trusted."""


class Jet(NamedTuple):
    """Colours, channels first, with their first and second derivatives by row and column."""

    colour: Float[np.ndarray, "3 points"]
    by_row: Float[np.ndarray, "3 points"]
    by_column: Float[np.ndarray, "3 points"]
    by_rows: Float[np.ndarray, "3 points"]
    by_both: Float[np.ndarray, "3 points"]
    by_columns: Float[np.ndarray, "3 points"]


class Surface:
    """Biquadratic in each cell of a grid of nodes, through the colours at its nine half steps.

    A place is a row and a column in steps between nodes, [2, points].
    """

    def __init__(self, halves: Float[np.ndarray, "rows columns 3"]):
        """`halves` are the colours at every half step: odd numbers of rows and columns."""
        self.last = np.array(halves.shape[:2])[:, None] // 2
        rows = np.stack([halves[k : halves.shape[0] - 2 + k : 2] for k in range(3)])
        nine = np.stack([rows[:, :, k : halves.shape[1] - 2 + k : 2] for k in range(3)])
        powers = np.einsum("pr,qc,crijk->pqkij", _TO_POWERS, _TO_POWERS, nine, optimize=True)
        self._patches = np.ascontiguousarray(powers.reshape(3, 3, 3, -1))

    def to(self, dtype: np.dtype) -> "Surface":
        """The same surface in another precision."""
        other = object.__new__(Surface)
        other.last, other._patches = self.last, self._patches.astype(dtype)
        return other

    def colour(self, place: Float[np.ndarray, "2 points"]) -> Float[np.ndarray, "3 points"]:
        """Colours at places on the grid."""
        patch, u, v = self._patch(place)
        value = patch[:, 0] + v * (patch[:, 1] + v * patch[:, 2])
        return np.asarray(value[0] + u * (value[1] + u * value[2]))

    def at(self, place: Float[np.ndarray, "2 points"]) -> Jet:
        """Colours at places on the grid, with their derivatives."""
        patch, u, v = self._patch(place)
        a, b, c = patch[:, 0], patch[:, 1], patch[:, 2]
        value, slope, curve = a + v * (b + v * c), b + 2 * v * c, c
        return Jet(
            value[0] + u * (value[1] + u * value[2]),
            2 * value[1] + 4 * u * value[2],
            2 * (slope[0] + u * (slope[1] + u * slope[2])),
            8 * value[2],
            4 * (slope[1] + 2 * u * slope[2]),
            8 * (curve[0] + u * (curve[1] + u * curve[2])),
        )

    def _patch(
        self, place: Float[np.ndarray, "2 points"]
    ) -> tuple[
        Float[np.ndarray, "3 3 3 points"], Float[np.ndarray, "points"], Float[np.ndarray, "points"]
    ]:
        """Coefficients of the cells by power in row and column, and the places in them, -1 to 1."""
        corner = place.astype(np.intp).clip(0, self.last - 1)
        u, v = 2 * (place - corner.astype(place.dtype)) - 1
        return self._patches.take(corner[0] * self.last[1] + corner[1], -1), u, v

    def foot(
        self, colours: Float[np.ndarray, "3 points"], place: Float[np.ndarray, "2 points"]
    ) -> Float[np.ndarray, "2 points"]:
        """Place of the point nearest to each colour, by Newton's steps from a place near it.

        Steps are Gauss and Newton's where the distance is not convex. They stay on the grid: a
        step that leaves it goes along its border. A colour rests once its step is below a
        thousandth of a node, for the next would be a millionth.
        """
        place = place.copy()
        moving = np.arange(place.shape[1])
        for _ in range(STEPS):
            start = place[:, moving]
            end = self._step(colours[:, moving], start)
            place[:, moving] = end
            moving = moving[np.abs(end - start).max(0) > RESTING]
            if not len(moving):
                break
        return place

    def _step(
        self, colours: Float[np.ndarray, "3 points"], place: Float[np.ndarray, "2 points"]
    ) -> Float[np.ndarray, "2 points"]:
        jet = self.at(place)
        away = colours - jet.colour
        pull = _dot(away, jet.by_row), _dot(away, jet.by_column)
        rr, rc, cc = _hessian(jet, away)
        low, high = -place, self.last.astype(place.dtype) - place
        row = ((cc * pull[0] - rc * pull[1]) / (rr * cc - rc**2)).clip(low[0], high[0])
        column = ((pull[1] - rc * row) / cc).clip(low[1], high[1])
        # Where the column was clipped, another row is best.
        row = ((pull[0] - rc * column) / rr).clip(low[0], high[0])
        return np.asarray(place + np.stack([row, column]))


def _hessian(jet: Jet, away: Float[np.ndarray, "3 points"]) -> Float[np.ndarray, "3 points"]:
    """Of half the squared distance, by row twice, both and column twice; positive definite."""
    # A little more than the rounding, so that slopes which are parallel can be divided by.
    ridge, tiny = 1 + 16 * np.finfo(away.dtype).eps, np.finfo(away.dtype).tiny ** 0.5
    flat = [ridge * _dot(jet.by_row, jet.by_row) + tiny, _dot(jet.by_row, jet.by_column)]
    flat += [ridge * _dot(jet.by_column, jet.by_column) + tiny]
    seconds = (jet.by_rows, jet.by_both, jet.by_columns)
    bent = [one - _dot(away, second) for one, second in zip(flat, seconds, strict=True)]
    area, least = (rr * cc - rc**2 for rr, rc, cc in (bent, flat))
    convex = (bent[0] > 0) & (area > CONVEX * least)
    return np.stack([np.where(convex, b, f) for b, f in zip(bent, flat, strict=True)])


def _dot(
    a: Float[np.ndarray, "3 points"], b: Float[np.ndarray, "3 points"]
) -> Float[np.ndarray, "points"]:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
