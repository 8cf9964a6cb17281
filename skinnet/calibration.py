"""The global colour transform between the skin model and recorded colours."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from skinnet.errors import InputError

DATA, MODEL = 20_000, 4_000
"""Colours of either side that are looked at, chosen by the seed."""

LEAST = 100
"""Colours without which nothing can be told."""

STARTS = (0.6, 0.8, 1.0, 1.25, 1.6)
"""Overall scales at which the alternation is begun, times the ratio of the medians."""

MIXING = 1e-2
"""Weight of the wish that channels mix little, as a share of the colours' own. Skin is so thin a
sheet in RGB that without it shading and gloss in real textures turn into mixtures of any size."""

ITERATIONS, SETTLED = 200, 1e-5
NEAR = 0.03
"""A model colour has data near it within this share of the data's length."""

SINGULAR = (0.05, 20.0)
"""Singular values of a transform, in units of the ratio of lengths; beyond, it has collapsed."""


@dataclass(frozen=True)
class Calibration:
    """transform @ model colour ~ recorded colour.

    `data_rms` and `model_rms` are distances from the data to the nearest transformed model colours
    and, of those that overlap, back, in the data's unit. `overlap` is the share of the model's
    colours that have data near them.
    """

    transform: Float[np.ndarray, "3 3"]
    data_rms: float
    model_rms: float
    overlap: float
    iterations: int
    converged: bool


def calibrate(
    data: Float[np.ndarray, "colours 3"], model: Float[np.ndarray, "nodes 3"], seed: int = 0
) -> Calibration:
    """The 3 x 3 transform of section 4.3 by bidirectional nearest neighbours.

    Alternates between matches and the least-squares transform. Every recorded colour is matched to
    the nearest model colour, which keeps the transform from growing, and every model colour that is
    somebody's nearest to the nearest recorded one, which keeps it from shrinking to a point; model
    colours that nobody is near are left out, so that data of some skin types do not pull the others
    over. Of several starts the one that ends closest, both ways, is taken.

    Raises `InputError` for too few colours, colours that are not finite, all one colour or on a
    line, and data that no transform brings near the model.
    """
    kept = _checked(data, "data"), _checked(model, "model")
    draw = np.random.default_rng(seed)
    data, model = (
        draw.permutation(one)[:most] for one, most in zip(kept, (DATA, MODEL), strict=True)
    )
    tree = cKDTree(data)
    ratio = np.median(data, 0) / np.median(model, 0)
    found = [_alternated(data, tree, model, np.diag(scale * ratio)) for scale in STARTS]
    best = min(found, key=lambda one: one.data_rms + one.model_rms)
    length = float(np.sqrt(np.mean((data**2).sum(1))))
    if best.data_rms > 0.2 * length:
        raise InputError(
            f"No transform brings these colours near those of skin: they stay {best.data_rms:.2g} "
            "away; take colours of skin, or name the right light and camera."
        )
    return best


def _alternated(
    data: Float[np.ndarray, "colours 3"],
    tree: cKDTree,
    model: Float[np.ndarray, "nodes 3"],
    transform: Float[np.ndarray, "3 3"],
) -> Calibration:
    """Matches and least squares in turn, from a start until the transform moves no more."""
    length = np.sqrt(np.mean((data**2).sum(1)) / np.mean((model**2).sum(1)))
    steps, moved = 0, float("inf")
    while steps < ITERATIONS and moved >= SETTLED:
        there, back, mutual = _matches(data, tree, model @ transform.T)
        # Each direction counts as much as the other, however many its colours.
        source = np.concatenate(
            [model[there] / len(there) ** 0.5, model[mutual] / mutual.sum() ** 0.5]
        )
        target = np.concatenate(
            [data / len(there) ** 0.5, data[back[mutual]] / mutual.sum() ** 0.5]
        )
        solved = _solved(source, target)
        left, singular, right = np.linalg.svd(solved)
        solved = (left * singular.clip(SINGULAR[0] * length, SINGULAR[1] * length)) @ right
        moved = float(np.linalg.norm(solved - transform) / np.linalg.norm(solved))
        transform, steps = solved, steps + 1
    return _described(data, tree, model, transform, steps, bool(moved < SETTLED))


def _solved(
    source: Float[np.ndarray, "pairs 3"], target: Float[np.ndarray, "pairs 3"]
) -> Float[np.ndarray, "3 3"]:
    """Least squares in which a channel is drawn towards its own gain alone, by `MIXING`."""
    gram = source.T @ source
    pull = MIXING * np.trace(gram) / 3
    rows = [
        np.linalg.solve(
            gram + pull * np.diag(np.arange(3) != channel), source.T @ target[:, channel]
        )
        for channel in range(3)
    ]
    return np.stack(rows)


def _matches(
    data: Float[np.ndarray, "colours 3"], tree: cKDTree, moved: Float[np.ndarray, "nodes 3"]
) -> tuple[np.ndarray, np.ndarray, Bool[np.ndarray, "nodes"]]:
    """Nearest node of each colour, nearest colour of each node, and the nodes that are nearest."""
    there = np.asarray(cKDTree(moved).query(data, workers=-1)[1])
    back = np.asarray(tree.query(moved, workers=-1)[1])
    mutual = np.zeros(len(moved), bool)
    mutual[there] = True
    return there, back, mutual


def _described(
    data: Float[np.ndarray, "colours 3"],
    tree: cKDTree,
    model: Float[np.ndarray, "nodes 3"],
    transform: Float[np.ndarray, "3 3"],
    steps: int,
    converged: bool,
) -> Calibration:
    moved = model @ transform.T
    to_model = np.asarray(cKDTree(moved).query(data, workers=-1)[0])
    to_data = np.asarray(tree.query(moved, workers=-1)[0])
    near = to_data < NEAR * np.sqrt(np.mean((data**2).sum(1)))
    back = float(np.sqrt(np.mean(to_data[near] ** 2))) if near.any() else float("inf")
    there = float(np.sqrt(np.mean(to_model**2)))
    return Calibration(transform, there, back, float(near.mean()), steps, converged)


def _checked(colours: Float[np.ndarray, "n channels"], name: str) -> Float[np.ndarray, "n 3"]:
    if colours.ndim != 2 or colours.shape[1] != 3:
        raise InputError(f"The {name} are colours [n, 3]; got shape {list(colours.shape)}.")
    if len(colours) < LEAST:
        raise InputError(f"There are {len(colours)} {name} colours, and {LEAST} are needed.")
    if not np.isfinite(colours).all():
        raise InputError(f"The {name} have colours that are not finite; mask them out.")
    spread = np.linalg.svd(colours - colours.mean(0), compute_uv=False) / len(colours) ** 0.5
    length = np.sqrt(np.mean((colours**2).sum(1)))
    if spread[0] < 0.02 * length:
        raise InputError(
            f"The {name} are all nearly one colour; a transform needs skins that differ."
        )
    if spread[1] < 0.002 * length:
        raise InputError(
            f"The {name} lie on a line; a transform needs skins of different redness too."
        )
    return colours.astype(np.float64)
