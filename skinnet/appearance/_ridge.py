"""Ridge regression at many places at once, with weights that take power from outliers."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

_ROUNDS, _HUBER = 6, 1.345
"""Rounds of reweighting, and Huber's constant: 95 % efficiency for normal errors."""

_CHUNK = 256
"""Places that are solved at once, which bounds the memory."""

Array = NDArray[np.float64]


def fit_places(design: Array, values: Array, ridge: float) -> Array:
    """Fit values at each place as a linear function of coefficients.

    Args:
        design: Coefficients of the frames, [frames, names].
        values: What is measured, [frames, places]; NaN where it is not.
        ridge: Added to each coefficient's sum of squares.

    Returns:
        Slopes, [names, places]; 0 where nothing is measured.
    """
    slopes = np.zeros((design.shape[1], values.shape[1]))
    measured = np.flatnonzero(np.isfinite(values).any(0))
    for start in range(0, len(measured), _CHUNK):
        part = measured[start : start + _CHUNK]
        slopes[:, part] = _fit_robustly(design, values[:, part], ridge)
    return slopes


def _fit_robustly(design: Array, values: Array, ridge: float) -> Array:
    known = np.isfinite(values)
    filled, weights = np.where(known, values, 0.0), known.astype(np.float64)
    slopes = _solve(design, filled, weights, ridge)
    for _ in range(_ROUNDS):
        residuals = np.abs(filled - design @ slopes)
        scale = np.nanmedian(np.where(known, residuals, np.nan), 0)
        limit = np.maximum(1.4826 * _HUBER * scale, 1e-9)
        weights = known * np.minimum(1, limit / np.maximum(residuals, 1e-12))
        slopes = _solve(design, filled, weights, ridge)
    return slopes


def _solve(design: Array, values: Array, weights: Array, ridge: float) -> Array:
    names = design.shape[1]
    squares = (weights.T @ (design[:, :, None] * design[:, None]).reshape(len(design), -1)).reshape(
        -1, names, names
    )
    right = np.einsum("fp,fn->pn", weights * values, design)
    solved = np.linalg.solve(squares + ridge * np.eye(names), right[..., None])
    return np.asarray(solved[..., 0].T)


def find_amounts(fields: Array, values: Array, ridge: float) -> Array:
    """Find the amounts from 0 to 1 of fields that explain values.

    Args:
        fields: [places, names].
        values: What is measured, [places]; NaN where it is not.
        ridge: Added to the sum of squares of each field.

    Returns:
        Amounts, [names].
    """
    known, names = np.isfinite(values), fields.shape[1]
    if not known.any():
        return np.zeros(names)
    design = np.concatenate([fields[known], np.sqrt(ridge) * np.eye(names)])
    wanted = np.concatenate([values[known], np.zeros(names)])
    return np.asarray(lsq_linear(design, wanted, (0, 1), method="bvls").x).clip(0, 1)
