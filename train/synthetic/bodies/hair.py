"""Hair on a synthetic head: a cap on the scalp, and a hanging surface for long hair."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.shape._procedural_head import ROUNDNESS
from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    clip_triangles,
    compute_normals,
    label_mesh,
    triangulate_grid,
)
from train.synthetic.labels import HAIR

_ROOT = -0.003
"""Hair starts a little under the skin, in half heads, so that no light gets between."""

_Points = Float[np.ndarray, "*points"]


class Haircut(NamedTuple):
    """A haircut: hairline and sides in radians, volume and length in half heads."""

    hairline: float
    sides: float
    volume: float
    length: float
    fringe: float
    parting: float


def sample_haircut(rng: np.random.Generator) -> Haircut:
    """Sample a haircut; one in five heads is bald, and half of all have long hair."""
    bald = rng.random() < 0.2
    hairline = rng.uniform(0.95, 1.4) if bald else rng.uniform(0.55, 0.95)
    long = rng.random() < (0.25 if bald else 0.56)
    length = rng.uniform(0.35, 1.3) if long else 0.0
    fringe = rng.uniform(0.3, 1.0) if rng.random() < 0.15 and not bald else 0.0
    sides, volume = rng.uniform(0.95, 1.45), rng.uniform(0.02, 0.22)
    return Haircut(hairline, sides, volume, length, fringe, rng.normal(0, 0.25))


def _measure_hairline(cut: Haircut, azimuth: _Points, elevation: _Points) -> _Points:
    """Distance from the hairline in radians, positive where hair grows."""
    side = np.abs(azimuth)
    line = cut.hairline - 0.25 * side**2
    low = 0.34 + 0.1 * np.cos(3 * azimuth + cut.parting)
    share = cut.fringe * np.exp(-(((azimuth - cut.parting) / 0.42) ** 4))
    line = line + share * (low - line).clip(max=0)
    nape = 0.25 + 0.4 * ((side - 1.7) / 0.4).clip(0, 1)
    temples = np.minimum(side - cut.sides, elevation + nape)
    ears = np.sqrt((side - 1.5) ** 2 / 0.5 + (elevation + 0.1) ** 2) - 0.22
    ears = np.where(side > 1.5, np.maximum(ears, side - 1.72), ears)
    top = np.minimum(elevation - line, elevation + nape)
    return np.asarray(np.maximum(top, np.minimum(temples, ears)))


def make_cap(skin: LabelledMesh, cut: Haircut, rng: np.random.Generator) -> LabelledMesh:
    """Make short hair: the scalp raised along its normals, more so far from the hairline."""
    off = _measure_hairline(cut, *skin.chart.T)
    columns = np.column_stack([skin.vertices, skin.chart, compute_normals(skin), off])
    columns, triangles, _ = clip_triangles(columns, skin.triangles, off)
    points, chart, normal = columns[:, :3], columns[:, 3:5], columns[:, 5:8]
    waves = _sample_waves(points, rng)
    height = _ROOT + cut.volume * (1 - np.exp(-columns[:, 8].clip(0) / 0.18)) * (1 + 0.3 * waves)
    return label_mesh(points + height[:, None] * normal, triangles, HAIR, chart)


def make_long_hair(skin: LabelledMesh, cut: Haircut, rng: np.random.Generator) -> LabelledMesh:
    """Make long hair that falls behind and beside the neck, open in front."""
    top = skin.vertices[:, 1].max() + 0.2 * cut.volume
    y = np.linspace(0.85 * top, -cut.length, 64)[:, None]
    share = np.linspace(-1, 1, 121)[None]
    opening = rng.uniform(0.95, 1.35) + 0.4 * (y - 0.2).clip(0)
    azimuth = np.pi + share * (np.pi - opening)
    half_width, half_depth = _measure_head(skin, y, 0.015 + 0.4 * cut.volume)
    round_ = (1 - (y.clip(0) / top) ** ROUNDNESS) ** (1 / ROUNDNESS)
    round_ = round_ + rng.uniform(-0.1, 0.12) * (-y).clip(0)
    ends = 0.08 * np.sin(rng.integers(3, 9) * azimuth + rng.uniform(0, 6)) * ((-y).clip(0) / 1.3)
    front = np.where(np.cos(azimuth) > 0, 0.55, half_depth)
    points = np.stack(
        np.broadcast_arrays(
            half_width * round_ * np.sin(azimuth), y + ends, front * round_ * np.cos(azimuth)
        ),
        -1,
    ).reshape(-1, 3)
    # In front it bends inwards: onto the temples above, behind the jaw below.
    inwards = 0.14 + 0.22 * ((0.1 - y) / 0.4).clip(0, 1)
    points[:, [0, 2]] *= (1 - inwards * np.abs(share) ** 9).reshape(-1, 1)
    points[:, [0, 2]] *= 1 + 0.04 * _sample_waves(points, rng)[:, None]
    wrapped = np.arctan2(np.sin(azimuth), np.cos(azimuth)) + 0 * y
    chart = np.stack([wrapped, np.arctan(y) + 0 * azimuth], -1).reshape(-1, 2)
    return label_mesh(points, triangulate_grid(64, 121)[:, ::-1], HAIR, chart)


def _measure_head(skin: LabelledMesh, y: _Points, off: float) -> tuple[_Points, float]:
    """Half the head's width at heights, ears under the hair, and its depth behind the ears."""
    x, height, z = np.abs(skin.vertices).T
    ears = x[height < 0.3].max()
    head = x[np.abs(skin.vertices[:, 1] - 0.45) < 0.08].max() / 0.95
    share = ((0.4 - y) / 0.3).clip(0, 1)
    half_width = head + (ears + 0.01 - head).clip(0) * share**2 * (3 - 2 * share)
    back = z[(height < 0.4) & (skin.vertices[:, 2] < 0)].max()
    return np.asarray(half_width + off), float(back + off)


def _sample_waves(points: Float[np.ndarray, "points 3"], rng: np.random.Generator) -> _Points:
    """Sample a smooth field of variance about one."""
    wave, phase = rng.normal(0, 4.0, (3, 6)), rng.uniform(0, 2 * np.pi, 6)
    return np.asarray(np.cos(points @ wave + phase).sum(1) / np.sqrt(3))
