"""Chest, shoulders and clothes under a synthetic head."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.labelled_mesh import Part, joined, part, sheet
from train.synthetic.labels import CLOTH, SKIN

TURNS, STEPS = 97, 48
BOTTOM = -3.6

Grid = Float[np.ndarray, "rows columns"]


class Neck(NamedTuple):
    """The neck's foot, about 1.3 half heads under the eyes: its middle and its half axes."""

    x: float
    z: float
    wide: float
    deep: float


class Build(NamedTuple):
    """How a torso is built: heights of its foot and fall of its shoulders, half axes."""

    foot: float
    fall: float
    wide: float
    deep: float
    edge: float


def bust(neck: Neck, draw: np.random.Generator) -> Part:
    """A chest of skin on which clothes lie, open at the collar."""
    build = Build(
        draw.uniform(-1.32, -1.18),
        draw.uniform(0.55, 0.9),
        draw.uniform(1.3, 1.7),
        draw.uniform(0.6, 0.75),
        draw.uniform(1.9, 2.6),
    )
    turn = np.linspace(-np.pi, np.pi, TURNS)
    return joined([_chest(neck, build, turn), _clothes(neck, build, turn, draw)])


def _chest(neck: Neck, build: Build, turn: Float[np.ndarray, "turns"]) -> Part:
    along = np.linspace(0, 1.2, STEPS)[:, None] + 0 * turn
    points = _torso(neck, build, along, turn + 0 * along)
    down = build.foot - points[..., 1]
    chart = np.stack([turn + 0 * along, -1.4 - 0.4 * down], -1)
    return part(points.reshape(-1, 3), sheet(*along.shape), SKIN, chart.reshape(-1, 2))


def _clothes(
    neck: Neck, build: Build, turn: Float[np.ndarray, "turns"], draw: np.random.Generator
) -> Part:
    wide, deep = draw.uniform(0.5, 1.1), draw.uniform(0.0, 0.55)
    front = np.abs(turn) / wide
    pointed, round_ = (1 - front).clip(0), np.exp(-(front**2) * 1.5)
    collar = draw.uniform(0.04, 0.2) + deep * (pointed if draw.random() < 0.5 else round_)
    share = np.linspace(0, 1, STEPS)[:, None] ** 1.3
    along = collar.clip(max=0.95) * (1 - share) + 2 * share
    points = _torso(neck, build, along, turn + 0 * along, draw.uniform(0.02, 0.05))
    chart = points[..., :2].reshape(-1, 2)
    return part(points.reshape(-1, 3), sheet(*along.shape), CLOTH, chart)


def _torso(
    neck: Neck, build: Build, along: Grid, turn: Grid, off: float = 0.0
) -> Float[np.ndarray, "rows columns 3"]:
    """Points from the neck (0) over the shoulders (1) down to the bottom (2), `off` the skin."""
    out = np.sin(along.clip(0, 1) * np.pi / 2)
    x = 0.9 * neck.wide * (1 - out) + build.wide * out
    z = 0.9 * neck.deep * (1 - out) + build.deep * out
    # A quarter of a superellipse ends upright, as arms and chest do; the neck rises from it.
    round_ = 1 - (1 - out**build.edge).clip(0) ** (1 / build.edge)
    y = build.foot + off + 0.3 * (1 - out) ** 4 - build.fall * (0.25 * out + 0.75 * round_)
    under = (along - 1).clip(0)
    y = y * (1 - under) + BOTTOM * under
    middle = neck.z - 0.1 * out
    return np.stack(
        [neck.x * (1 - out) + (x + off) * np.sin(turn), y, middle + (z + off) * np.cos(turn)], -1
    )
