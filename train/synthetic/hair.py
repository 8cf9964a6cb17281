"""Hair on a synthetic head: a cap on the scalp, and a curtain if it is long."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.shape.procedural_head import ROUNDNESS
from train.synthetic.labelled_mesh import Part, clip, normals, part, sheet
from train.synthetic.labels import HAIR

ROOT = -0.003
"""Hair starts a little under the skin, in half heads, so that no light falls between."""

Points = Float[np.ndarray, "*points"]


class Cut(NamedTuple):
    """A haircut: hairline and sides in radians, volume and length in half heads."""

    hairline: float
    sides: float
    volume: float
    length: float
    fringe: float
    parting: float


def draw_cut(draw: np.random.Generator) -> Cut:
    bald = draw.random() < 0.2
    hairline = draw.uniform(0.95, 1.4) if bald else draw.uniform(0.55, 0.95)
    long = draw.random() < (0.25 if bald else 0.56)
    length = draw.uniform(0.35, 1.3) if long else 0.0
    fringe = draw.uniform(0.3, 1.0) if draw.random() < 0.15 and not bald else 0.0
    sides, volume = draw.uniform(0.95, 1.45), draw.uniform(0.02, 0.22)
    return Cut(hairline, sides, volume, length, fringe, draw.normal(0, 0.25))


def scalp(cut: Cut, azimuth: Points, elevation: Points) -> Points:
    """Radians from the hairline, positive where hair grows."""
    side = np.abs(azimuth)
    line = cut.hairline - 0.25 * side**2
    low = 0.34 + 0.1 * np.cos(3 * azimuth + cut.parting)
    share = cut.fringe * np.exp(-(((azimuth - cut.parting) / 0.42) ** 4))
    line = line + share * (low - line).clip(max=0)
    nape = 0.25 + 0.4 * ((side - 1.7) / 0.4).clip(0, 1)
    temples = np.minimum(side - cut.sides, elevation + nape)
    ears = np.sqrt((side - 1.5) ** 2 / 0.5 + (elevation + 0.1) ** 2) - 0.22
    ears = np.where(side > 1.5, np.maximum(ears, side - 1.72), ears)
    return np.maximum(np.minimum(elevation - line, elevation + nape), np.minimum(temples, ears))


def cap(skin: Part, cut: Cut, draw: np.random.Generator) -> Part:
    """The scalp raised along its normals, more the further it is from the hairline."""
    off = scalp(cut, *skin.chart.T)
    columns = np.column_stack([skin.vertices, skin.chart, normals(skin), off])
    columns, triangles, _ = clip(columns, skin.triangles, off)
    points, chart, normal = columns[:, :3], columns[:, 3:5], columns[:, 5:8]
    waves = _waves(points, draw)
    height = ROOT + cut.volume * (1 - np.exp(-columns[:, 8].clip(0) / 0.18)) * (1 + 0.3 * waves)
    return part(points + height[:, None] * normal, triangles, HAIR, chart)


def curtain(skin: Part, cut: Cut, draw: np.random.Generator) -> Part:
    """Long hair that falls behind and beside the neck, open in front."""
    top = skin.vertices[:, 1].max() + 0.2 * cut.volume
    y = np.linspace(0.85 * top, -cut.length, 64)[:, None]
    share = np.linspace(-1, 1, 121)[None]
    opening = draw.uniform(0.95, 1.35) + 0.4 * (y - 0.2).clip(0)
    turn = np.pi + share * (np.pi - opening)
    wide, deep = _girth(skin, y, 0.015 + 0.4 * cut.volume)
    round_ = (1 - (y.clip(0) / top) ** ROUNDNESS) ** (1 / ROUNDNESS)
    round_ = round_ + draw.uniform(-0.1, 0.12) * (-y).clip(0)
    ends = 0.08 * np.sin(draw.integers(3, 9) * turn + draw.uniform(0, 6)) * ((-y).clip(0) / 1.3)
    front = np.where(np.cos(turn) > 0, 0.55, deep)
    points = np.stack(
        np.broadcast_arrays(wide * round_ * np.sin(turn), y + ends, front * round_ * np.cos(turn)),
        -1,
    ).reshape(-1, 3)
    # In front it turns inwards: onto the temples above, behind the jaw below.
    inwards = 0.14 + 0.22 * ((0.1 - y) / 0.4).clip(0, 1)
    points[:, [0, 2]] *= (1 - inwards * np.abs(share) ** 9).reshape(-1, 1)
    points[:, [0, 2]] *= 1 + 0.04 * _waves(points, draw)[:, None]
    azimuth = np.arctan2(np.sin(turn), np.cos(turn)) + 0 * y
    chart = np.stack([azimuth, np.arctan(y) + 0 * turn], -1).reshape(-1, 2)
    return part(points, sheet(64, 121)[:, ::-1], HAIR, chart)


def _girth(skin: Part, y: Points, off: float) -> tuple[Points, float]:
    """Half a head's width at heights with hair over the ears, and its depth behind."""
    x, height, z = np.abs(skin.vertices).T
    ears = x[height < 0.3].max()
    head = x[np.abs(skin.vertices[:, 1] - 0.45) < 0.08].max() / 0.95
    share = ((0.4 - y) / 0.3).clip(0, 1)
    wide = head + (ears + 0.01 - head).clip(0) * share**2 * (3 - 2 * share)
    back = z[(height < 0.4) & (skin.vertices[:, 2] < 0)].max()
    return wide + off, back + off


def _waves(points: Float[np.ndarray, "points 3"], draw: np.random.Generator) -> Points:
    """A smooth field of variance about one."""
    wave, phase = draw.normal(0, 4.0, (3, 6)), draw.uniform(0, 2 * np.pi, 6)
    return np.cos(points @ wave + phase).sum(1) / np.sqrt(3)
