"""Which patches of a chart lie in the same light."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ROUNDS = 12
"""Rounds of alternating least squares; more change the scales by less than 1 %."""

_TRIALS, _WITHIN = 400, 0.09
"""Planes that are tried, and distance in log brightness within which a patch lies on one."""

_STEEPEST = 0.5
"""Largest change of the logarithm of even light over half the chart."""


def find_lit(observed: Array, colours: Array, places: Array, usable: NDArray[np.bool_]) -> Array:
    """Find the largest set of patches in light that changes evenly over the chart.

    Args:
        observed: Linear sRGB of the patches in the photograph [n, 3].
        colours: Those of the chart [n, 3].
        places: Where the patches lie, from -1 to 1 [n, 2].
        usable: Which patches may be used [n].

    Returns:
        Logarithm of the light on each patch over that on the set [n]; about 0 in it.

    Source:
        Colours up to a factor for each patch by alternating least squares: Finlayson, Gong and
        Fisher, Color homography, 2016.
    """
    scale = _find_scales(observed, colours, usable)
    logs = np.log(np.maximum(scale, 1e-3))
    # A tone curve that is not known changes brightness with brightness.
    bright = np.log(np.maximum(colours.mean(1), 0.01))
    design = np.c_[np.ones(len(logs)), places, bright - bright.mean()]
    return np.asarray(logs - design @ _find_plane(design, logs, usable))


def _find_scales(observed: Array, colours: Array, usable: NDArray[np.bool_]) -> Array:
    weights = usable / np.maximum(colours.mean(1), 0.02)
    scale = np.ones(len(observed))
    for _ in range(_ROUNDS):
        left = (weights * scale)[:, None] * colours
        matrix = np.linalg.lstsq(left, weights[:, None] * observed, rcond=None)[0]
        shown = colours @ matrix
        scale = (shown * observed).sum(1) / np.maximum((shown**2).sum(1), 1e-9)
        scale = scale / np.median(scale[usable])
    return scale


def _find_plane(design: Array, logs: Array, usable: NDArray[np.bool_]) -> Array:
    """Coefficients of the plane near which most patches lie."""
    rng = np.random.default_rng(0)
    numbers = np.flatnonzero(usable)
    best, most = np.zeros(4), -1.0
    for _ in range(_TRIALS):
        chosen = rng.choice(numbers, 5, replace=False)
        plane = np.linalg.lstsq(design[chosen], logs[chosen], rcond=None)[0]
        if np.abs(plane[1:]).max() > _STEEPEST:
            continue
        residual = np.abs(logs - design @ plane)
        score = float(np.maximum(1 - (residual / _WITHIN) ** 2, 0)[usable].sum())
        if score > most:
            best, most = plane, score
    near = usable & (np.abs(logs - design @ best) < _WITHIN)
    if near.sum() < 6:
        return best
    return np.asarray(np.linalg.lstsq(design[near], logs[near], rcond=None)[0])
