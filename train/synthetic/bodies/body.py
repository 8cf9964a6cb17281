"""Chest, shoulders and clothes under a synthetic head."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, label_mesh, triangulate_grid
from train.synthetic.labels import CLOTH, SKIN

_AZIMUTHS, _STEPS = 97, 48
_BOTTOM = -3.6

_Grid = Float[np.ndarray, "rows columns"]


class Neck(NamedTuple):
    """Base of the neck, about 1.3 half heads under the eyes: its middle and its half axes."""

    x: float
    z: float
    half_width: float
    half_depth: float


class _Torso(NamedTuple):
    """Height of the neck's base, drop of the shoulders, half axes, and exponent of the outline."""

    base: float
    drop: float
    half_width: float
    half_depth: float
    edge: float


def make_bust(neck: Neck, rng: np.random.Generator, closed: bool = False) -> LabelledMesh:
    """Make a chest with skin, and clothes on it that are open at the collar.

    Args:
        neck: Where the neck ends.
        rng: Random numbers.
        closed: Whether the clothes end at the neck all around, as under a roll-neck.

    Returns:
        Chest and clothes.
    """
    torso = _Torso(
        rng.uniform(-1.32, -1.18),
        rng.uniform(0.55, 0.9),
        rng.uniform(1.3, 1.7),
        rng.uniform(0.6, 0.75),
        rng.uniform(1.9, 2.6),
    )
    azimuth = np.linspace(-np.pi, np.pi, _AZIMUTHS)
    clothes = _make_clothes(neck, torso, azimuth, rng, closed)
    return join([_make_chest(neck, torso, azimuth), clothes])


def _make_chest(neck: Neck, torso: _Torso, azimuth: Float[np.ndarray, "azimuths"]) -> LabelledMesh:
    along = np.linspace(0, 1.2, _STEPS)[:, None] + 0 * azimuth
    points = _place_on_torso(neck, torso, along, azimuth + 0 * along)
    down = torso.base - points[..., 1]
    chart = np.stack([azimuth + 0 * along, -1.4 - 0.4 * down], -1)
    return label_mesh(
        points.reshape(-1, 3), triangulate_grid(*along.shape), SKIN, chart.reshape(-1, 2)
    )


def _make_clothes(
    neck: Neck,
    torso: _Torso,
    azimuth: Float[np.ndarray, "azimuths"],
    rng: np.random.Generator,
    closed: bool,
) -> LabelledMesh:
    width, depth = rng.uniform(0.5, 1.1), rng.uniform(0.0, 0.55) * (not closed)
    front = np.abs(azimuth) / width
    pointed, round_ = (1 - front).clip(0), np.exp(-(front**2) * 1.5)
    lowest = rng.uniform(0.04, 0.2) * (not closed)
    collar = lowest + depth * (pointed if rng.random() < 0.5 else round_)
    share = np.linspace(0, 1, _STEPS)[:, None] ** 1.3
    along = collar.clip(max=0.95) * (1 - share) + 2 * share
    points = _place_on_torso(neck, torso, along, azimuth + 0 * along, rng.uniform(0.02, 0.05))
    chart = points[..., :2].reshape(-1, 2)
    return label_mesh(points.reshape(-1, 3), triangulate_grid(*along.shape), CLOTH, chart)


def _place_on_torso(
    neck: Neck, torso: _Torso, along: _Grid, azimuth: _Grid, off: float = 0.0
) -> Float[np.ndarray, "rows columns 3"]:
    """Points from the neck (0) over the shoulders (1) to the bottom (2), `off` outside the skin."""
    out = np.sin(along.clip(0, 1) * np.pi / 2)
    x = 0.9 * neck.half_width * (1 - out) + torso.half_width * out
    z = 0.9 * neck.half_depth * (1 - out) + torso.half_depth * out
    # A quarter of a superellipse ends upright, as arms and chest do; the neck rises from it.
    round_ = 1 - (1 - out**torso.edge).clip(0) ** (1 / torso.edge)
    y = torso.base + off + 0.3 * (1 - out) ** 4 - torso.drop * (0.25 * out + 0.75 * round_)
    under = (along - 1).clip(0)
    y = y * (1 - under) + _BOTTOM * under
    middle = neck.z - 0.1 * out
    return np.stack(
        [neck.x * (1 - out) + (x + off) * np.sin(azimuth), y, middle + (z + off) * np.cos(azimuth)],
        -1,
    )
