"""A smooth surface of colours through a table, and the point on it closest to a colour."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

_TO_POWERS = np.array([[0, 1, 0], [-0.5, 0, 0.5], [0.5, -1, 0.5]])
"""Values at -1, 0 and 1 to the coefficients of the parabola through them."""

_MAX_STEPS, _LAST_STEP = 8, 1e-3
"""Largest number of Newton steps, and the length in nodes below which a step is the last."""

_CONVEX = 0.1
"""Smallest determinant of the Hessian for which Newton's step is used, relative to that of the
Gauss-Newton matrix."""


class Derivatives(NamedTuple):
    """Colours, channels first, with their first and second derivatives by row and column."""

    colour: Float[np.ndarray, "3 points"]
    row: Float[np.ndarray, "3 points"]
    column: Float[np.ndarray, "3 points"]
    row_row: Float[np.ndarray, "3 points"]
    row_column: Float[np.ndarray, "3 points"]
    column_column: Float[np.ndarray, "3 points"]


class ColourSurface:
    """Surface that is biquadratic in each cell of a grid of nodes.

    It interpolates nine colours of each cell: its nodes, and the half steps between them. A
    position [2, points] is a row and a column, counted in nodes from the first.
    """

    def __init__(self, half_steps: Float[np.ndarray, "rows columns 3"]) -> None:
        """`half_steps` are the colours at every half step: odd numbers of rows and columns."""
        self.last = np.array(half_steps.shape[:2])[:, None] // 2
        rows, columns = half_steps.shape[:2]
        thirds = np.stack([half_steps[k : rows - 2 + k : 2] for k in range(3)])
        nine = np.stack([thirds[:, :, k : columns - 2 + k : 2] for k in range(3)])
        powers = np.einsum("pr,qc,crijk->pqkij", _TO_POWERS, _TO_POWERS, nine, optimize=True)
        self._coefficients = np.ascontiguousarray(powers.reshape(3, 3, 3, -1))

    def to(self, dtype: np.dtype) -> "ColourSurface":
        """Convert the surface to another precision."""
        other = object.__new__(ColourSurface)
        other.last, other._coefficients = self.last, self._coefficients.astype(dtype)
        return other

    def evaluate(self, position: Float[np.ndarray, "2 points"]) -> Float[np.ndarray, "3 points"]:
        """Compute the colours at positions."""
        cell, u, v = self._cells(position)
        value = cell[:, 0] + v * (cell[:, 1] + v * cell[:, 2])
        return np.asarray(value[0] + u * (value[1] + u * value[2]))

    def differentiate(self, position: Float[np.ndarray, "2 points"]) -> Derivatives:
        """Compute the colours at positions, and their derivatives."""
        cell, u, v = self._cells(position)
        a, b, c = cell[:, 0], cell[:, 1], cell[:, 2]
        value, first, second = a + v * (b + v * c), b + 2 * v * c, c
        return Derivatives(
            value[0] + u * (value[1] + u * value[2]),
            2 * value[1] + 4 * u * value[2],
            2 * (first[0] + u * (first[1] + u * first[2])),
            8 * value[2],
            4 * (first[1] + 2 * u * first[2]),
            8 * (second[0] + u * (second[1] + u * second[2])),
        )

    def _cells(
        self, position: Float[np.ndarray, "2 points"]
    ) -> tuple[
        Float[np.ndarray, "3 3 3 points"], Float[np.ndarray, "points"], Float[np.ndarray, "points"]
    ]:
        """Coefficients of the cells by power in row and column; positions in them, -1 to 1."""
        corner = position.astype(np.intp).clip(0, self.last - 1)
        u, v = 2 * (position - corner.astype(position.dtype)) - 1
        return self._coefficients.take(corner[0] * self.last[1] + corner[1], -1), u, v

    def project(
        self, colours: Float[np.ndarray, "3 points"], start: Float[np.ndarray, "2 points"]
    ) -> Float[np.ndarray, "2 points"]:
        """Find the position of the point closest to each colour, from a position near it.

        Newton's steps minimise the squared distance within the grid; Gauss-Newton steps replace
        them where the distance is not convex. A colour is done when its step is below a thousandth
        of a node: convergence is quadratic, so the next step would be about a millionth.
        """
        position = start.copy()
        moving = np.arange(position.shape[1])
        for _ in range(_MAX_STEPS):
            before = position[:, moving]
            after = self._step(colours[:, moving], before)
            position[:, moving] = after
            moving = moving[np.abs(after - before).max(0) > _LAST_STEP]
            if not len(moving):
                break
        return position

    def _step(
        self, colours: Float[np.ndarray, "3 points"], position: Float[np.ndarray, "2 points"]
    ) -> Float[np.ndarray, "2 points"]:
        derivatives = self.differentiate(position)
        residual = colours - derivatives.colour
        descent = np.stack([_dot(residual, derivatives.row), _dot(residual, derivatives.column)])
        hessian = _hessian(derivatives, residual)
        low, high = -position, self.last.astype(position.dtype) - position
        return np.asarray(position + clipped_newton_step(descent, hessian, low, high))


def clipped_newton_step(
    descent: Float[np.ndarray, "2 points"],
    hessian: Float[np.ndarray, "3 points"],
    low: Float[np.ndarray, "2 points"],
    high: Float[np.ndarray, "2 points"],
) -> Float[np.ndarray, "2 points"]:
    """Minimise a convex quadratic of two variables within bounds.

    The first variable of Newton's step is clipped, then the second is optimised for it and clipped,
    then the first is optimised again for the second. This is exact unless both would be clipped;
    then the quadratic still decreases.

    Args:
        descent: Negative gradient where the step starts.
        hessian: Second derivatives: by the first variable twice, by both, by the second twice.
        low: Least step, at most 0.
        high: Greatest step, at least 0.

    Returns:
        The step.
    """
    aa, ab, bb = hessian
    first = ((bb * descent[0] - ab * descent[1]) / (aa * bb - ab**2)).clip(low[0], high[0])
    second = ((descent[1] - ab * first) / bb).clip(low[1], high[1])
    first = ((descent[0] - ab * second) / aa).clip(low[0], high[0])
    return np.stack([first, second])


def _hessian(
    derivatives: Derivatives, residual: Float[np.ndarray, "3 points"]
) -> Float[np.ndarray, "3 points"]:
    """Positive definite Hessian of half the squared distance: by row, both, and column."""
    # Slightly more than rounding, so that parallel derivatives do not divide by zero.
    ridge, tiny = 1 + 16 * np.finfo(residual.dtype).eps, np.finfo(residual.dtype).tiny ** 0.5
    row, column = derivatives.row, derivatives.column
    gauss_newton = [ridge * _dot(row, row) + tiny, _dot(row, column)]
    gauss_newton += [ridge * _dot(column, column) + tiny]
    seconds = (derivatives.row_row, derivatives.row_column, derivatives.column_column)
    newton = [
        one - _dot(residual, second) for one, second in zip(gauss_newton, seconds, strict=True)
    ]
    determinant, least = (aa * bb - ab**2 for aa, ab, bb in (newton, gauss_newton))
    convex = (newton[0] > 0) & (determinant > _CONVEX * least)
    return np.stack([np.where(convex, n, g) for n, g in zip(newton, gauss_newton, strict=True)])


def _dot(
    a: Float[np.ndarray, "3 points"], b: Float[np.ndarray, "3 points"]
) -> Float[np.ndarray, "points"]:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
