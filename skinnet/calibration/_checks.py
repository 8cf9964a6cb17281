"""Colours and models that cannot be calibrated are refused with a sentence."""

import numpy as np
from jaxtyping import Float, Shaped

from skinnet.errors import InputError

_MIN_COLOURS, _MIN_SIDE = 100, 8
"""Colours, and rows or columns of the model, below which nine entries are not determined."""


def check_data(colours: Float[np.ndarray, "n channels"]) -> Float[np.ndarray, "n 3"]:
    if colours.ndim != 2 or colours.shape[1] != 3:
        raise InputError(f"The data are colours [n, 3]; got shape {list(colours.shape)}.")
    if len(colours) < _MIN_COLOURS:
        raise InputError(f"There are {len(colours)} data colours, and {_MIN_COLOURS} are needed.")
    if not np.isfinite(colours).all():
        raise InputError("The data have colours that are not finite; mask them out.")
    spread = np.linalg.svd(colours - colours.mean(0), compute_uv=False) / len(colours) ** 0.5
    length = root_mean_square(colours)
    if spread[0] < 0.02 * length:
        raise InputError(
            f"The data are all nearly one colour: they vary by {spread[0] / length:.2%}. A "
            "transform needs skins that differ."
        )
    if spread[1] < 0.002 * length:
        raise InputError(
            f"The data lie on a line, within {spread[1] / length:.2%}. A transform needs skins of "
            "different redness too."
        )
    if not (colours.mean(0) > 0).all():
        raise InputError(
            f"The data's mean is {colours.mean(0).round(3).tolist()}; skin reflects in all "
            "channels. Give linear RGB from which no offset was taken."
        )
    return colours.astype(np.float64)


def check_model(
    model: Shaped[np.ndarray, "*nodes channels"],
) -> Float[np.ndarray, "rows columns 3"]:
    """Check the model's colours. One list is a grid if neighbours in it follow smoothly."""
    if model.ndim not in (2, 3) or model.shape[-1] != 3 or not np.isfinite(model).all():
        raise InputError(
            f"The model is a finite grid of colours [rows, columns, 3]; got {list(model.shape)}."
        )
    grids = [model.astype(np.float64)]
    if model.ndim == 2:
        sides = [n for n in range(_MIN_SIDE, len(model) // _MIN_SIDE + 1) if len(model) % n == 0]
        grids = [grids[0].reshape(-1, side, 3) for side in sides]
    grids = [g for g in grids if min(g.shape[:2]) >= _MIN_SIDE and _roughness(g) < 0.5]
    if not grids:
        raise InputError(
            f"The model's colours, {list(model.shape)}, are not a smooth grid of {_MIN_SIDE} rows "
            "and columns at least; give it as a grid [rows, columns, 3] over melanin and "
            "hemoglobin."
        )
    return min(grids, key=_roughness)


def _roughness(grid: Float[np.ndarray, "rows columns 3"]) -> float:
    """How much steps from node to node change, in units of the steps, along the worse axis."""
    return max(
        float(np.abs(np.diff(grid, 2, axis)).sum() / (np.abs(np.diff(grid, 1, axis)).sum() + 1e-30))
        for axis in (0, 1)
    )


def root_mean_square(colours: Float[np.ndarray, "n 3"]) -> float:
    """Root mean square length."""
    return float(np.sqrt(np.mean((colours**2).sum(1))))
