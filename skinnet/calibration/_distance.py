"""Distances of recorded colours from the transformed colour surface of the model."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from skinnet.physics._colour_surface import ColourSurface


class Match(NamedTuple):
    """Recorded colours and their closest points on the surface, in compressed colours.

    `model` is the untransformed colour of the closest point, `distance` the distance from it,
    `derivatives` those of the distance by the nine entries of the transform, and `normals` those
    of the distance from the tangent plane. `inside` is False on the boundary of the surface.
    """

    model: Float[np.ndarray, "3 points"]
    distance: Float[np.ndarray, "points"]
    derivatives: Float[np.ndarray, "points 9"]
    normals: Float[np.ndarray, "points 9"]
    inside: Bool[np.ndarray, "points"]


class GamutDistance:
    """Distance from recorded colours to the gamut, as a function of the transform.

    Noise grows with the colour, so distances are measured after arcsinh(colour / level), which is
    linear in the dark and logarithmic in the bright. `level` is where noise turns from constant to
    proportional, as a share of the median value. `log_scale` is the mean logarithm of colours per
    unit of distance: it makes likelihoods under different levels comparable.
    """

    def __init__(
        self,
        colours: Float[np.ndarray, "colours 3"],
        grid: Float[np.ndarray, "rows columns 3"],
        level: float,
    ) -> None:
        self._level = level * float(np.median(np.abs(colours)))
        self.log_scale = float(np.log(np.hypot(colours, self._level)).mean())
        self._colours = self._compress(colours.T)
        self._half_steps = grid
        for axis in (0, 1):
            count = grid.shape[axis]
            spline = CubicSpline(np.arange(count), self._half_steps, axis=axis)
            self._half_steps = spline(np.arange(2 * count - 1) / 2)
        self._model = ColourSurface(self._half_steps)

    def match(self, transform: Float[np.ndarray, "3 3"], margin: float = 0.0) -> Match:
        """Match every recorded colour to the closest point of the continuous surface.

        Noise carries colours over the boundary. Where the closest point is on it, the component
        along the surface counts only beyond `margin`; otherwise noise would stretch the gamut.
        """
        compressed = self._compress(self._half_steps @ transform.T)
        surface, nodes = ColourSurface(compressed), compressed[::2, ::2]
        nearest = cKDTree(nodes.reshape(-1, 3)).query(self._colours.T)[1]
        start = np.stack(np.divmod(nearest, nodes.shape[1])).astype(np.float64)
        position = surface.project(self._colours, start)
        point = surface.differentiate(position)
        model = self._model.evaluate(position)
        gap = self._colours - point.colour
        slope = 1 / np.hypot(transform @ model, self._level)
        normal = np.cross(point.row, point.column, axis=0)
        gap = _shorten_along_surface(gap, normal, margin)
        distance = np.linalg.norm(gap, axis=0)
        inside = np.all((position > 0) & (position < surface.last), axis=0)

        def differentiate(direction: Float[np.ndarray, "3 points"]) -> Float[np.ndarray, "_ 9"]:
            # The closest point follows along the surface: only this component changes.
            unit = direction / np.maximum(np.linalg.norm(direction, axis=0), 1e-12)
            return np.asarray(-((unit * slope)[:, None] * model).reshape(9, -1).T)

        return Match(model, distance, differentiate(gap), differentiate(normal), np.asarray(inside))

    def measure_coverage(self, transform: Float[np.ndarray, "3 3"]) -> float:
        """Median distance from the model's nodes to the closest recorded colours."""
        nodes = self._compress(self._half_steps[::2, ::2].reshape(-1, 3) @ transform.T)
        return float(np.median(self._tree.query(nodes)[0]))

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self._colours.T)

    def _compress(self, colours: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
        return np.asarray(np.arcsinh(colours / self._level))


def _shorten_along_surface(
    gap: Float[np.ndarray, "3 points"], normal: Float[np.ndarray, "3 points"], margin: float
) -> Float[np.ndarray, "3 points"]:
    unit = normal / np.maximum(np.linalg.norm(normal, axis=0), 1e-12)
    along = gap - (gap * unit).sum(0) * unit
    length = np.maximum(np.linalg.norm(along, axis=0), 1e-12)
    return np.asarray(gap - along * np.minimum(margin / length, 1.0))
