"""Where recorded colours end, beside where the sheet of the model's colours ends."""

from itertools import product
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.special import ndtr

from skinnet.calibration.sheet import Noise, Sheet

STRETCHES = 8
"""Parts into which each of the four edges is divided."""

BIN, DEPTH, PAST = 0.2, 5.0, 6.0
"""Standard deviations: of a bin of the count, and what is counted before and past an edge."""

FARTHEST = 30.0
"""Standard deviations from the sheet's edge within which that of the data is looked for."""

NARROW = 15.0
"""Standard deviations across a sheet below which its two edges blur into each other."""

LEAST = 20
"""Colours near an edge without which nothing is said about it."""

BLURS = (1.0, 2.0, 4.0)
"""Widths of the fall of the count, in those of the noise: only the first is a sheet's edge."""

PILED = (0.0, 0.1, 0.25, 0.5, 1.0)
"""Shares of the colours that lie right at the edge, as those of a table's last nodes do."""

STRAY = 1e-3
"""Share of colours that lie anywhere."""

UNSURE, SOFTER = 3.0, 3.0
"""Most standard error of an edge, and the log-likelihood by which a softer fall, or a pile, has to
be better than a plain end before it is believed."""


class Edges(NamedTuple):
    """Stretches at which data end sharply, near where the sheet does.

    `shift` is how far past the sheet's edge the data reach, in standard deviations of the noise,
    `error` its standard error, and `slopes` what moves the sheet's edge outwards: by slopes . D for
    a change D of the transform.
    """

    slopes: Float[np.ndarray, "edges 9"]
    shift: Float[np.ndarray, "edges"]
    error: Float[np.ndarray, "edges"]


def edges_of(
    sheet: Sheet,
    transform: Float[np.ndarray, "3 3"],
    colours: Float[np.ndarray, "3 points"],
    places: Float[np.ndarray, "2 points"],
    noise: Noise,
    covariance: Float[np.ndarray, "9 9"],
    extra: float,
) -> Edges:
    """The edges that can be seen, for colours on the sheet and a transform known to `covariance`.

    Data that cover a part of the sheet end inside it; such an end is farther from the sheet's than
    the transform's error (three times it, and `extra`), or it is soft, and is left out.
    """
    rows = []
    for axis, end in product((0, 1), (0, 1)):
        outward, slopes, width = _outward(sheet, transform, colours, places, noise, axis, end)
        part = (places[1 - axis] / sheet.last[1 - axis] * STRETCHES).clip(-1, STRETCHES)
        for stretch in range(STRETCHES):
            here = (np.floor(part) == stretch) & (np.abs(outward) < FARTHEST + DEPTH + PAST)
            if here.sum() < LEAST or np.median(width[here]) < NARROW:
                continue
            slope = slopes[:, here].mean(1)
            reach = min(3 * float(slope @ covariance @ slope) ** 0.5 + extra, FARTHEST)
            seen = _end(outward[here], reach)
            if seen is not None:
                rows.append((slope, *seen))
    return Edges(
        np.array([row[0] for row in rows]).reshape(-1, 9),
        np.array([row[1] for row in rows], np.float64),
        np.array([row[2] for row in rows], np.float64),
    )


def _outward(
    sheet: Sheet,
    transform: Float[np.ndarray, "3 3"],
    colours: Float[np.ndarray, "3 points"],
    places: Float[np.ndarray, "2 points"],
    noise: Noise,
    axis: int,
    end: int,
) -> tuple[Float[np.ndarray, "points"], Float[np.ndarray, "9 points"], Float[np.ndarray, "points"]]:
    """How far colours lie past an edge, what moves it, and the sheet's width, in deviations."""
    at = places.copy()
    at[axis] = end * sheet.last[axis]
    jet = sheet.surface.differentiate(at)
    edge = transform @ jet.colour
    deviation = noise.deviation(edge)
    over, along = (transform @ slope / deviation for slope in (jet.row, jet.column))
    if axis == 1:
        over, along = along, over
    tiny = np.finfo(np.float64).tiny ** 0.5
    over = over - (over * along).sum(0) / ((along**2).sum(0) + tiny) * along
    length = np.sqrt((over**2).sum(0)) + tiny
    over = over * (2 * end - 1) / length
    slopes = (over / deviation)[:, None] * jet.colour
    outward = (over * (colours - edge) / deviation).sum(0)
    return outward, slopes.reshape(9, -1), length * sheet.last[axis]


def _end(outward: Float[np.ndarray, "points"], reach: float) -> tuple[float, float] | None:
    """Where a count ends within the reach, and its standard error; None where it does not.

    The count is even up to the end, with a pile there, and blurred by the noise. The mean and the
    deviation are those of its likelihood.
    """
    count, bins = np.histogram(outward, np.arange(-reach - DEPTH, reach + PAST, BIN))
    if count.sum() < LEAST:
        return None
    ends = np.arange(-reach - 1, reach + 1, BIN)
    likelihoods = [_likelihood(count, bins, ends, blur) for blur in BLURS]
    best = [float(np.logaddexp.reduce(one)) for one in likelihoods]
    weight = np.exp(likelihoods[0] - best[0])
    mean = float(weight @ ends)
    error = float(weight @ (ends - mean) ** 2 + BIN**2 / 12) ** 0.5
    if error > UNSURE or abs(mean) > reach or best[0] < max(best) - SOFTER:
        return None
    return mean, error


def _likelihood(
    count: np.ndarray,
    bins: Float[np.ndarray, "bounds"],
    ends: Float[np.ndarray, "ends"],
    blur: float,
) -> Float[np.ndarray, "ends"]:
    """Log-likelihood of each end, over all piles."""
    inwards = (ends[:, None] - (bins[:-1] + BIN / 2)) / blur
    even, pile = ndtr(inwards), np.exp(-0.5 * inwards**2)
    even, pile = (one / one.sum(1, keepdims=True) for one in (even, pile))
    each = [
        np.log((1 - share) * even + share * pile + STRAY / len(count)) @ count
        - (SOFTER if share else 0.0)
        for share in PILED
    ]
    return np.asarray(np.logaddexp.reduce(each))
