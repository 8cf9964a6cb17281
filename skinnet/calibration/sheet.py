"""The model's sheet of colours under a transform, and recorded colours around it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.interpolate import CubicSpline
from scipy.optimize import nnls
from scipy.spatial import cKDTree

from skinnet.errors import InputError
from skinnet.physics._colour_surface import ColourSurface

NEWTON = 3.0
"""Nodes that a step to a foot crosses at most."""

WITHIN = 3.0
"""Standard deviations beyond which a residual says nothing about the noise."""

KEPT = 0.973
"""Variance of a normal deviate that is cut at `WITHIN`."""

FOLD = 1e-9
"""Share by which slopes that are parallel are told apart."""

System = tuple[Float[np.ndarray, "9 9"], Float[np.ndarray, "9"]]


class Noise(NamedTuple):
    """Independent noise of a channel: a share of the colour, and a level in the colours' unit."""

    share: float
    level: float

    def deviation(self, colours: Float[np.ndarray, "3 points"]) -> Float[np.ndarray, "3 points"]:
        """Standard deviations of colours."""
        return np.asarray(np.sqrt((self.share * colours) ** 2 + self.level**2))


class Around(NamedTuple):
    """Colours less their feet, in standard deviations, without what the feet can take up.

    `across` is the projector onto what they cannot: the normal of the sheet, or of its border for
    those that are not `inside`. `model` is the untransformed colour of the foot.
    """

    model: Float[np.ndarray, "3 points"]
    residual: Float[np.ndarray, "3 points"]
    across: Float[np.ndarray, "3 3 points"]
    deviation: Float[np.ndarray, "3 points"]
    inside: Bool[np.ndarray, "points"]

    @property
    def squared(self) -> Float[np.ndarray, "points"]:
        """Squared length of the residual."""
        return np.asarray((self.residual**2).sum(0))

    def system(self, weight: Float[np.ndarray, "points"]) -> System:
        """Normal equations of the transform's nine entries, row by row, with the feet profiled out.

        To first order a change D of the transform moves a residual by -across (D model), since the
        foot follows along the sheet (variable projection).
        """
        metric = self.across / (self.deviation[:, None] * self.deviation) * weight
        pairs = (self.model[:, None] * self.model).reshape(9, -1)
        blocks = (metric.reshape(9, -1) @ pairs.T).reshape(3, 3, 3, 3)
        pull = (self.residual / self.deviation * weight) @ self.model.T
        return blocks.transpose(0, 2, 1, 3).reshape(9, 9), pull.ravel()


class Sheet:
    """A smooth sheet through a grid of the model's colours [rows, columns, 3].

    A place is a row and a column in steps between nodes. Past the border the last cells go on.
    """

    def __init__(self, grid: Float[np.ndarray, "rows columns 3"]) -> None:
        self.nodes = grid.reshape(-1, 3)
        self.columns = grid.shape[1]
        for axis in (0, 1):
            halves = np.arange(0, grid.shape[axis] - 0.75, 0.5)
            grid = CubicSpline(np.arange(grid.shape[axis]), grid, axis=axis)(halves)
        self.surface = ColourSurface(grid)
        self.last = self.surface.last.astype(np.float64)

    def nearest(
        self, transform: Float[np.ndarray, "3 3"], colours: Float[np.ndarray, "3 points"]
    ) -> Float[np.ndarray, "2 points"]:
        """Places of the nodes nearest to colours, where a share counts as it does for dark ones."""
        small = 0.01 * np.abs(colours).mean(1)
        moved = np.arcsinh(self.nodes @ transform.T / small)
        found = np.asarray(cKDTree(moved).query(np.arcsinh(colours.T / small))[1])
        return np.stack(np.divmod(found, self.columns)).astype(np.float64)

    def feet(
        self,
        transform: Float[np.ndarray, "3 3"],
        colours: Float[np.ndarray, "3 points"],
        places: Float[np.ndarray, "2 points"],
        deviation: Float[np.ndarray, "3 points"],
        margin: float = 0.0,
        steps: int = 3,
    ) -> Float[np.ndarray, "2 points"]:
        """Nearest places in standard deviations, by Gauss and Newton's steps from places near them.

        `margin` is the share of the sheet's length by which a place may lie past the border.
        """
        beyond = margin * self.last
        for _ in range(steps):
            jet = self.surface.differentiate(places)
            away = (colours - transform @ jet.colour) / deviation
            a, b = (transform @ slope / deviation for slope in (jet.row, jet.column))
            low = np.maximum(-beyond - places, -NEWTON)
            high = np.minimum(self.last + beyond - places, NEWTON)
            places = places + _step(a, b, away, low, high)
        return places

    def around(
        self,
        transform: Float[np.ndarray, "3 3"],
        colours: Float[np.ndarray, "3 points"],
        places: Float[np.ndarray, "2 points"],
        deviation: Float[np.ndarray, "3 points"],
        margin: float = 0.0,
    ) -> Around:
        """What is left of colours beside the sheet at their feet."""
        jet = self.surface.differentiate(places)
        beyond = margin * self.last
        free = (places > -beyond) & (places < self.last + beyond)
        a, b = (transform @ slope / deviation for slope in (jet.row, jet.column))
        a = _unit(a * free[0])
        b = b * free[1]
        b = _unit(b - (b * a).sum(0) * a)
        across = np.eye(3)[:, :, None] - a[:, None] * a - b[:, None] * b
        away = (colours - transform @ jet.colour) / deviation
        residual = np.einsum("abn,bn->an", across, away)
        return Around(jet.colour, residual, across, deviation, free[0] & free[1])


def noise_of(around: Around, transform: Float[np.ndarray, "3 3"], unit: float) -> Noise:
    """The noise that explains the residuals across the sheet; `unit` is a usual colour."""
    squared = around.squared
    inside = around.inside
    if not inside.any():
        raise InputError("No colour lies on the sheet of skin; take colours of skin.")
    kept = inside & (squared < WITHIN**2 * np.median(squared[inside]) / 0.455)
    normal = (np.einsum("aan->an", around.across) / around.deviation**2)[:, kept]
    shares = (normal * (transform @ around.model[:, kept]) ** 2).sum(0)
    rows = np.stack([shares, (normal * unit**2).sum(0)], 1)
    seen, weight = squared[kept] / KEPT, np.ones(int(kept.sum()))
    for _ in range(5):
        variances = nnls(rows * weight[:, None], seen * weight)[0]
        weight = 1 / np.maximum(rows @ variances, 1e-12 * seen.max())
    share, level = np.sqrt(variances)
    return Noise(max(float(share), 1e-5), unit * max(float(level), 1e-6))


def _step(
    a: Float[np.ndarray, "3 points"],
    b: Float[np.ndarray, "3 points"],
    away: Float[np.ndarray, "3 points"],
    low: Float[np.ndarray, "2 points"],
    high: Float[np.ndarray, "2 points"],
) -> Float[np.ndarray, "2 points"]:
    """Least squares of `away` in the slopes a and b, within bounds."""
    aa, ab, bb = (a * a).sum(0) * (1 + FOLD), (a * b).sum(0), (b * b).sum(0) * (1 + FOLD)
    aa, bb = aa + FOLD**2, bb + FOLD**2
    pa, pb = (a * away).sum(0), (b * away).sum(0)
    row = ((bb * pa - ab * pb) / (aa * bb - ab**2)).clip(low[0], high[0])
    column = ((pb - ab * row) / bb).clip(low[1], high[1])
    # Where the column was clipped, another row is best.
    row = ((pa - ab * column) / aa).clip(low[0], high[0])
    return np.stack([row, column])


def _unit(vectors: Float[np.ndarray, "3 points"]) -> Float[np.ndarray, "3 points"]:
    length = np.sqrt((vectors**2).sum(0))
    return np.asarray(np.where(length > FOLD, vectors / np.maximum(length, FOLD), 0.0))
