"""Orthogonal distance regression of the transform between a sheet and recorded colours."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from skinnet.calibration.edges import Edges, edges_of
from skinnet.calibration.sheet import Around, Noise, Sheet, noise_of

CAUCHY, TUKEY = 2.4, 4.7
"""Robust weights' scales, in standard deviations: 95 % efficient where the noise is normal."""

STEPS, SETTLED = 60, 1e-5
ROUNDS, RESTING = 12, 3e-4
"""Most steps, and the relative change of the transform that is the last."""

RELEASED = 8
"""Rounds after which nothing but the sheet's interior and its edges holds the transform."""

MARGIN = 0.05
"""Share of its length by which the sheet goes on past its border, for colours that noise moved."""

START, DAMPED, LARGEST = 1e-3, 8, 0.1
"""Damping of the first step, tries to damp one more, and the largest relative step of a round."""

FIRST, LATER = 6.0, 2.0
"""Standard deviations of the noise that an edge may be off beside the transform's error."""


@dataclass(frozen=True)
class Fit:
    """A transform and what it leaves.

    `information` [9, 9] is Fisher's of its entries, row by row. `cost` is that of the residuals in
    the given deviations, up to a constant. `excess` is the mean square of the edges' misfit in
    standard errors.
    """

    transform: Float[np.ndarray, "3 3"]
    places: Float[np.ndarray, "2 points"]
    deviation: Float[np.ndarray, "3 points"]
    information: Float[np.ndarray, "9 9"]
    cost: float
    steps: int
    converged: bool = False
    edges: int = 0
    excess: float = 0.0

    @property
    def uncertainty(self) -> float:
        """Relative standard error of the transform, in the Frobenius norm."""
        variance = np.trace(_inverse(self.information)) * max(self.excess, 1.0)
        return float(np.sqrt(variance) / np.linalg.norm(self.transform))


def fitted(
    sheet: Sheet,
    colours: Float[np.ndarray, "3 points"],
    transform: Float[np.ndarray, "3 3"],
    noise: Noise,
) -> Fit:
    """The transform that brings the sheet, up to its border, nearest to all colours.

    Levenberg and Marquardt's steps with every colour's foot profiled out, and Cauchy's weights. The
    sheet does not slide along itself as under alternating matches, which take hundreds of steps
    where this takes ten. Colours that noise moved past the border draw it outwards: a start.
    """
    deviation = noise.deviation(colours)
    places = sheet.feet(transform, colours, sheet.nearest(transform, colours), deviation, steps=4)
    around = sheet.around(transform, colours, places, deviation)
    damping, steps, moved = START, 0, float("inf")
    while steps < STEPS and moved > SETTLED:
        scale = _scale(around)
        information, pull = around.system(1 / (1 + around.squared / scale**2))
        before = np.log1p(around.squared / scale**2).sum()
        for _ in range(DAMPED):
            step = _solved(information + damping * np.diag(np.diag(information)), pull)
            other = transform + step
            feet = sheet.feet(other, colours, places, deviation)
            there = sheet.around(other, colours, feet, deviation)
            if np.log1p(there.squared / scale**2).sum() <= before:
                break
            damping *= 8
        else:
            break
        moved = _length(step) / _length(other)
        transform, places, around = other, feet, there
        damping, steps = damping / 5, steps + 1
    scale = _scale(around)
    information, _ = around.system(CAUCHY**2 / (scale**2 + around.squared))
    return Fit(transform, places, deviation, information, _cost(around), steps)


def refined(sheet: Sheet, colours: Float[np.ndarray, "3 points"], start: Fit) -> Fit:
    """The transform from the inside of the sheet and from those of its edges that the data show.

    Inside, a colour tells only how far it lies off the sheet, in units of the noise that all
    residuals have together. That holds the transform loosely, because a thin sheet slides along
    itself; an edge at which data end as sharply as the noise allows holds it well. The start is let
    go of round by round.
    """
    fit, unit = start, float(np.median(np.abs(colours)))
    known, hold, moved = start.information / 4, 1.0, float("inf")
    while fit.steps < start.steps + ROUNDS and (hold > 0 or moved > RESTING):
        rounds = fit.steps - start.steps
        around, noise = _renoised(sheet, colours, fit, unit)
        extra = LATER if rounds else FIRST
        edges = edges_of(sheet, fit.transform, colours, fit.places, noise, _inverse(known), extra)
        information, pull, excess = _together(around, edges)
        known = information + hold * start.information
        step = _solved(known, pull)
        moved = _length(step) / _length(fit.transform)
        transform = fit.transform + step * min(1, LARGEST / moved)
        deviation = around.deviation
        places = sheet.feet(transform, colours, fit.places, deviation, MARGIN, 2)
        fit = Fit(
            transform,
            places,
            deviation,
            information,
            0.0,
            fit.steps + 1,
            False,
            len(edges.shift),
            excess,
        )
        hold = hold / 4 if rounds < RELEASED else 0.0
    feet = sheet.feet(fit.transform, colours, fit.places, start.deviation, MARGIN, 2)
    last = sheet.around(fit.transform, colours, feet, start.deviation, MARGIN)
    return replace(fit, cost=_cost(last), converged=moved <= max(RESTING, fit.uncertainty / 2))


def _renoised(
    sheet: Sheet, colours: Float[np.ndarray, "3 points"], fit: Fit, unit: float
) -> tuple[Around, Noise]:
    """Residuals in units of the noise that they have themselves."""
    around = sheet.around(fit.transform, colours, fit.places, fit.deviation, MARGIN)
    noise = noise_of(around, fit.transform, unit)
    deviation = noise.deviation(fit.transform @ around.model)
    places = sheet.feet(fit.transform, colours, fit.places, deviation, MARGIN, 2)
    return sheet.around(fit.transform, colours, places, deviation, MARGIN), noise


def _together(
    around: Around, edges: Edges
) -> tuple[Float[np.ndarray, "9 9"], Float[np.ndarray, "9"], float]:
    """Normal equations of residuals, by Tukey's weights, and of edges, by Cauchy's; and excess."""
    weight = (1 - around.squared / TUKEY**2).clip(0) ** 2 * around.inside
    information, pull = around.system(weight)
    misfit = edges.shift / edges.error
    trust = 1 / (1 + (misfit / 3) ** 2) / edges.error**2
    information = information + edges.slopes.T @ (edges.slopes * trust[:, None])
    pull = pull + edges.slopes.T @ (edges.shift * trust)
    return information, pull, float(np.mean(misfit**2)) if len(misfit) else 0.0


def _scale(around: Around) -> float:
    return CAUCHY * 1.4826 * float(np.sqrt(np.median(around.squared))) + 1e-9


def _cost(around: Around) -> float:
    scale = _scale(around)
    return float(np.log1p(around.squared / scale**2).sum() + around.squared.size * np.log(scale))


def _solved(
    information: Float[np.ndarray, "9 9"], pull: Float[np.ndarray, "9"]
) -> Float[np.ndarray, "3 3"]:
    return np.asarray((_inverse(information) @ pull).reshape(3, 3))


def _inverse(information: Float[np.ndarray, "9 9"]) -> Float[np.ndarray, "9 9"]:
    # Channels differ by orders of magnitude: the inverse is that of the correlations.
    scale = np.sqrt(np.diag(information)) + np.finfo(np.float64).tiny ** 0.5
    return np.asarray(
        np.linalg.pinv(information / np.outer(scale, scale), 1e-14, True) / np.outer(scale, scale)
    )


def _length(matrix: Float[np.ndarray, "3 3"]) -> float:
    return float(np.linalg.norm(matrix))
