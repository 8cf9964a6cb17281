"""The global colour transform between the skin model and recorded colours."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Shaped
from scipy.spatial import cKDTree

from skinnet.calibration.regression import Fit, fitted, refined
from skinnet.calibration.sheet import Noise, Sheet
from skinnet.errors import InputError

DATA, SOME = 40_000, 4_000
"""Recorded colours that are looked at, and with which a start is looked for; the seed chooses."""

LEAST, SIDE = 100, 8
"""Colours, and rows or columns of the sheet, without which nothing can be told."""

STARTS = (0.4, 0.63, 1.0, 1.6, 2.5)
"""Overall scales at which is begun, times the ratio of the means."""

ALTERNATIONS = 5
"""Rounds of nearest neighbours both ways from each start."""

ROUGH = 0.01
"""Noise that is taken for granted until it is measured, of a colour and of the median one."""

ALIKE, WORSE = 0.02, 15.0
"""Relative distance below which two ends are one, and log-likelihood by which one has lost."""

NEAR = 0.03
"""A model colour has data near it within this share of the data's length."""

AWAY = 0.1
"""Root mean square distance from the sheet, as a share of the data's length, that is not skin's."""

SINGULAR = (0.02, 50.0)
"""Singular values of a transform, in units of the ratio of lengths; beyond, it has collapsed."""


@dataclass(frozen=True)
class Calibration:
    """transform @ model colour ~ recorded colour.

    `data_rms` and `model_rms` are distances in the data's unit: from the data to the transformed
    sheet and, from those of its nodes that have data near them, back. `overlap` is the share of
    such nodes. `uncertainty` is the relative standard error of the transform (Frobenius norm) that
    noise alone leaves: from the sheet's inside, and from the `edges` at which the data end with it.
    """

    transform: Float[np.ndarray, "3 3"]
    data_rms: float
    model_rms: float
    overlap: float
    uncertainty: float
    edges: int
    iterations: int
    converged: bool


def calibrate(
    data: Float[np.ndarray, "colours channels"],
    model: Shaped[np.ndarray, "*nodes channels_of_model"],
    seed: int = 0,
) -> Calibration:
    """The 3 x 3 transform of section 4.3, from linear RGB of skin alone.

    `model` is the sheet of the model's colours as a grid [rows, columns, 3] over melanin and
    hemoglobin, or the same with its nodes in one list, row by row. Bidirectional nearest neighbours
    as in the paper give starts; beyond the paper, `fitted` takes the nearest points of the
    continuous sheet, and `refined` weighs them by their noise and ties the sheet's edges to those
    of the data where data end sharply. The likeliest of all starts goes on.

    Raises `InputError` for too few colours, colours that are not finite, all one colour or on a
    line, a model that is no sheet, and data that no transform brings near the model.
    """
    sheet = Sheet(_grid(model))
    drawn = np.random.default_rng(seed).permutation(_checked(data))[:DATA]
    colours = np.ascontiguousarray(drawn.T)
    usual = colours.mean(1)
    if not (usual > 0).all():
        raise InputError(
            f"The data's mean is {usual.round(3).tolist()}; skin reflects in all channels. Give "
            "linear RGB from which no offset was taken."
        )
    noise = Noise(ROUGH, ROUGH * float(np.median(np.abs(colours))))
    starts = _starts(sheet, colours[:, :SOME], noise)
    fits = [fitted(sheet, colours, one, noise) for one in starts]
    best = min(fits, key=lambda fit: fit.cost)
    return _described(sheet, colours, refined(sheet, colours, best))


def _starts(
    sheet: Sheet, colours: Float[np.ndarray, "3 some"], noise: Noise
) -> list[Float[np.ndarray, "3 3"]]:
    """Transforms that explain some of the colours about equally well, the best first."""
    ratio = colours.mean(1) / sheet.nodes.mean(0)
    fits = [
        fitted(sheet, colours, _alternated(colours.T, sheet.nodes, np.diag(scale * ratio)), noise)
        for scale in STARTS
    ]
    fits.sort(key=lambda fit: fit.cost)
    kept: list[Float[np.ndarray, "3 3"]] = []
    for fit in fits:
        near = ALIKE * np.linalg.norm(fit.transform)
        new = all(np.linalg.norm(fit.transform - one) > near for one in kept)
        if new and fit.cost < fits[0].cost + WORSE:
            kept.append(fit.transform)
    return kept


def _alternated(
    data: Float[np.ndarray, "colours 3"],
    model: Float[np.ndarray, "nodes 3"],
    transform: Float[np.ndarray, "3 3"],
) -> Float[np.ndarray, "3 3"]:
    """Nearest neighbours both ways and least squares in turn, a few times.

    Every recorded colour is matched to the nearest model colour, which keeps the transform from
    growing, and every model colour that is somebody's nearest to the nearest recorded one, which
    keeps it from shrinking to a point.
    """
    tree = cKDTree(data)
    for _ in range(ALTERNATIONS):
        there, back, mutual = _matches(data, tree, model @ transform.T)
        # Each direction counts as much as the other, however many its colours.
        weights = len(there) ** -0.5, mutual.sum() ** -0.5
        source = np.concatenate([model[there] * weights[0], model[mutual] * weights[1]])
        target = np.concatenate([data * weights[0], data[back[mutual]] * weights[1]])
        transform = np.linalg.lstsq(source, target)[0].T
    return transform


def _matches(
    data: Float[np.ndarray, "colours 3"], tree: cKDTree, moved: Float[np.ndarray, "nodes 3"]
) -> tuple[np.ndarray, np.ndarray, Bool[np.ndarray, "nodes"]]:
    """Nearest node of each colour, nearest colour of each node, and the nodes that are nearest."""
    there = np.asarray(cKDTree(moved).query(data)[1])
    back = np.asarray(tree.query(moved)[1])
    mutual = np.zeros(len(moved), bool)
    mutual[there] = True
    return there, back, mutual


def _described(sheet: Sheet, colours: Float[np.ndarray, "3 points"], fit: Fit) -> Calibration:
    moved, length = sheet.nodes @ fit.transform.T, _length(colours.T)
    places = fit.places.clip(0, sheet.last)
    there = _length((colours - fit.transform @ sheet.surface.evaluate(places)).T)
    singular = np.linalg.svd(fit.transform, compute_uv=False) * _length(sheet.nodes) / length
    # A transform that mirrors channels or flattens them shows that no other came near.
    flat = singular[-1] < SINGULAR[0] or singular[0] > SINGULAR[1]
    if there > AWAY * length or flat or np.linalg.det(fit.transform) <= 0:
        raise InputError(
            f"No transform brings these colours near those of skin: they stay {there:.2g} away, at "
            f"singular values {singular.round(3).tolist()}. Take colours of skin, of more kinds or "
            "with less noise, or name the right light and camera."
        )
    to_data = np.asarray(cKDTree(colours.T).query(moved)[0])
    near = to_data < NEAR * length
    back = float(np.sqrt(np.mean(to_data[near] ** 2))) if near.any() else float("inf")
    return Calibration(
        fit.transform,
        there,
        back,
        float(near.mean()),
        fit.uncertainty,
        fit.edges,
        fit.steps,
        fit.converged,
    )


def _checked(colours: Float[np.ndarray, "n channels"]) -> Float[np.ndarray, "n 3"]:
    if colours.ndim != 2 or colours.shape[1] != 3:
        raise InputError(f"The data are colours [n, 3]; got shape {list(colours.shape)}.")
    if len(colours) < LEAST:
        raise InputError(f"There are {len(colours)} data colours, and {LEAST} are needed.")
    if not np.isfinite(colours).all():
        raise InputError("The data have colours that are not finite; mask them out.")
    spread = np.linalg.svd(colours - colours.mean(0), compute_uv=False) / len(colours) ** 0.5
    length = _length(colours)
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
    return colours.astype(np.float64)


def _grid(model: Shaped[np.ndarray, "*nodes channels"]) -> Float[np.ndarray, "rows columns 3"]:
    """The model's colours as a grid. One list is a grid if neighbours in it follow smoothly."""
    if model.ndim not in (2, 3) or model.shape[-1] != 3 or not np.isfinite(model).all():
        raise InputError(
            f"The model is a finite grid of colours [rows, columns, 3]; got {list(model.shape)}."
        )
    grids = [model.astype(np.float64)]
    if model.ndim == 2:
        sides = [n for n in range(SIDE, len(model) // SIDE + 1) if len(model) % n == 0]
        grids = [grids[0].reshape(-1, side, 3) for side in sides]
    grids = [grid for grid in grids if min(grid.shape[:2]) >= SIDE and _bend(grid) < 0.5]
    if not grids:
        raise InputError(
            f"The model's colours, {list(model.shape)}, are no smooth sheet of {SIDE} rows and "
            "columns at least; give it as a grid [rows, columns, 3] over melanin and hemoglobin."
        )
    return min(grids, key=_bend)


def _bend(grid: Float[np.ndarray, "rows columns 3"]) -> float:
    """How much steps from node to node change, in units of the steps, along the worse axis."""
    return max(
        float(np.abs(np.diff(grid, 2, axis)).sum() / (np.abs(np.diff(grid, 1, axis)).sum() + 1e-30))
        for axis in (0, 1)
    )


def _length(colours: Float[np.ndarray, "n 3"]) -> float:
    """Root mean square length."""
    return float(np.sqrt(np.mean((colours**2).sum(1))))
