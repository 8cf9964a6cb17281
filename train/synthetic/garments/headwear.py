"""Hats, headscarves, veils, turbans and hoods as shells over a head."""

from collections.abc import Callable

import numpy as np

from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.labelled_mesh import LabelledMesh, clip, join
from train.synthetic.bodies.shell import (
    Grid,
    HeadSurface,
    Points,
    make_room_for_ears,
    make_sheet,
    move_out,
    sample_waves,
    stretch,
)
from train.synthetic.labels import HEADWEAR

_COLUMNS, _ROWS = 121, 40

HAIR_ROOM = 0.07
"""Least distance between a hat and the skin in half heads, which leaves room for flat hair."""


def make_beanie(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a knitted cap, with a cuff or without."""
    azimuth, up, elevation = _lay_crown(rng.uniform(0.4, 0.58), rng.uniform(-0.12, 0.25), -0.3)
    cuff = rng.choice([0.0, 0.045]) * (1 / (1 + np.exp((up - 0.28) / 0.01)))
    slouch = rng.uniform(0, 0.22) * up**3
    ribs = 0.006 * np.cos(rng.choice([56, 80]) * azimuth) * np.cos(elevation)
    waves = 0.012 * sample_waves(rng, np.sin(azimuth), up, (5, 4))
    off = HAIR_ROOM + make_room_for_ears(azimuth, elevation)
    points = stretch(surface.place(azimuth, elevation), off, 60)
    points = move_out(points, cuff + slouch + ribs + waves * (up > 0.1))
    return make_sheet(_tuck_rim(points, 0.04), HEADWEAR, azimuth, up)


def make_cap(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a baseball cap, one in five worn backwards."""
    middle = np.pi if rng.random() < 0.2 else 0.0
    low, high = rng.uniform(-0.05, 0.15), rng.uniform(0.42, 0.6)
    azimuth, up, elevation = _lay_crown(high, 0.3, low)
    points = stretch(surface.place(azimuth, elevation), HAIR_ROOM, 200)
    ahead = np.arctan2(np.sin(azimuth - middle), np.cos(azimuth - middle))
    seams = 0.008 * np.exp(-((np.sin(3 * azimuth) / 0.06) ** 2)) * (up > 0.05)
    front = 0.06 * np.exp(-((ahead / 0.9) ** 2)) * np.sin(np.pi * up)
    points = move_out(points, front - seams)
    reach = rng.uniform(0.5, 0.68) * (1 - (np.abs(ahead[-1]) / 1.05) ** 2.5).clip(0)
    fall, bend = rng.uniform(0.12, 0.4), rng.uniform(0.05, 0.2)
    visor = _make_brim(points[-1], azimuth[-1], reach, fall, bend)
    return join([make_sheet(_tuck_rim(points, 0.04), HEADWEAR, azimuth, up), visor])


def make_brimmed_hat(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a hat with a brim all around, of straw or felt."""
    azimuth, up, elevation = _lay_crown(rng.uniform(0.44, 0.58), 0.32, rng.uniform(0.0, 0.2))
    points = stretch(surface.place(azimuth, elevation), HAIR_ROOM, 300)
    tall, dent = rng.uniform(0.08, 0.35), rng.uniform(0, 0.15)
    points[..., 1] += tall * up**0.8 - dent * np.exp(-((points[..., 0] / 0.15) ** 2)) * up**4
    band = 0.012 * (up < 0.25)
    points = move_out(points, band + 0.008 * sample_waves(rng, np.sin(azimuth), up, (4, 3)))
    side = azimuth[-1]
    reach = rng.uniform(0.3, 0.75) * (1 + 0.1 * np.cos(2 * side))
    brim = _make_brim(points[-1], side, reach, rng.uniform(-0.1, 0.3), rng.uniform(-0.15, 0.15))
    return join([make_sheet(points, HEADWEAR, azimuth, up), brim])


def make_hard_hat(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a helmet of building sites."""
    azimuth, up, elevation = _lay_crown(rng.uniform(0.42, 0.56), 0.32, 0.15)
    points = stretch(surface.place(azimuth, elevation), 0.13, 600)
    ridges = np.exp(-((np.sin(azimuth) / 0.12) ** 2)) + np.exp(-((points[..., 0] / 0.05) ** 2))
    points = move_out(points, 0.025 * ridges.clip(0, 1) * np.sin(np.pi * up.clip(0.08, 0.92)))
    side = azimuth[-1]
    reach = 0.08 + rng.uniform(0.1, 0.22) * (1 - (np.abs(side) / 1.2) ** 2).clip(0)
    brim = _make_brim(points[-1], side, reach, 0.3, 0.05)
    return join([make_sheet(points, HEADWEAR, azimuth, up), brim])


def make_turban(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a turban, whose wraps cross in front."""
    azimuth, up, elevation = _lay_crown(rng.uniform(0.42, 0.55), rng.uniform(0.0, 0.2), -0.2)
    off = HAIR_ROOM + 0.03 + make_room_for_ears(azimuth, elevation)
    points = stretch(surface.place(azimuth, elevation), off, 300)
    lean = rng.uniform(0.12, 0.3)
    height = elevation + lean * np.abs(np.sin(azimuth / 2)) - lean
    height = height + 0.012 * sample_waves(rng, azimuth, up, (2, 3))
    wraps = 1 - (2 * ((height * rng.uniform(6, 10)) % 1) - 1) ** 4
    thick = rng.uniform(0.1, 0.28) * np.sin(np.pi * (0.1 + 0.8 * up)) * (1 - up**6)
    folds = 0.006 * sample_waves(rng, azimuth, 8 * height, (1.5, 6))
    points = move_out(points, thick + 0.035 * wraps * (1 - up**4) + folds)
    return make_sheet(_tuck_rim(points, 0.06), HEADWEAR, azimuth, height)


def make_headscarf(surface: HeadSurface, neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make a headscarf around face and neck, as a hijab is worn."""
    wide, high = rng.uniform(0.82, 1.12), rng.uniform(0.42, 0.68)
    chin = rng.uniform(-1.16, -1.04)

    def measure(azimuth: Grid, elevation: Grid) -> Grid:
        middle = (high + chin) / 2
        up = (elevation - middle) / ((high - chin) / 2)
        return np.asarray(np.abs(azimuth / wide) ** 2.6 + np.abs(up) ** 2.6 - 1)

    return _make_hood(surface, neck, rng, measure, 0.03)


def make_veil(surface: HeadSurface, neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make a veil that leaves the eyes, as a niqab does."""
    wide, high = rng.uniform(0.62, 0.9), rng.uniform(0.16, 0.4)
    low = rng.uniform(-0.22, -0.1)

    def measure(azimuth: Grid, elevation: Grid) -> Grid:
        middle, sag = (high + low) / 2, 0.08 * (azimuth / wide) ** 2
        up = (elevation + sag - middle) / ((high - low) / 2)
        return np.asarray(np.abs(azimuth / wide) ** 4 + np.abs(up) ** 3 - 1)

    return _make_hood(surface, neck, rng, measure, 0.03, rng.uniform(0.1, 0.25))


def make_balaclava(surface: HeadSurface, neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make a tight hood with an opening for the eyes or for the face."""
    low = rng.choice([-0.2, -0.95])
    wide, high = (0.72, 0.3) if low > -0.5 else (0.78, 0.45)

    def measure(azimuth: Grid, elevation: Grid) -> Grid:
        up = (elevation - (high + low) / 2) / ((high - low) / 2)
        return np.asarray(np.abs(azimuth / wide) ** 2.6 + np.abs(up) ** 2.6 - 1)

    return _make_hood(surface, neck, rng, measure, 0.0)


def _lay_crown(front: float, sides: float, back: float) -> tuple[Grid, Grid, Grid]:
    """Azimuth, share of the way up from the rim, and elevation; rows go down to the rim."""
    azimuth = np.linspace(-np.pi, np.pi, _COLUMNS)[None]
    up = np.linspace(1, 0, _ROWS)[:, None]
    rim = (front + 2 * sides + back) / 4 + (front - back) / 2 * np.cos(azimuth)
    rim = rim + (front - 2 * sides + back) / 4 * np.cos(2 * azimuth)
    elevation = rim + (np.pi / 2 - rim) * up
    return azimuth + 0 * up, up + 0 * azimuth, elevation


def _tuck_rim(points: Points, depth: float) -> Points:
    """Bend the last row inwards, so that the rim has a thickness."""
    inner = move_out(points[-1:], np.full((1, points.shape[1]), -depth))
    return np.concatenate([points[1:], inner])


def _make_brim(
    rim: np.ndarray, side: np.ndarray, reach: np.ndarray, fall: float, bend: float
) -> LabelledMesh:
    """Make a brim from the rim outwards.

    Args:
        rim: Points of the rim, [columns, 3].
        side: Their azimuths.
        reach: Width of the brim at each, in half heads.
        fall: How far it falls for each unit of width.
        bend: How far its sides bend down.

    Returns:
        Its upper and lower side in one sheet.
    """
    share = np.linspace(0, 1, 12)[:, None, None]
    out = np.stack([np.sin(side), 0 * side, np.cos(side)], -1)
    width = reach[None, :, None] * share
    points = rim - 0.03 * out + width * out + [0, 0.03, 0] * (1 - share)
    points[..., 1] -= fall * width[..., 0] + bend * width[..., 0] * np.sin(side) ** 2
    under = points - [0, 0.02, 0]
    edge = np.concatenate([points, under[::-1]])
    lie = np.concatenate([share, share[::-1]])[..., 0]
    return make_sheet(edge, HEADWEAR, side[None] + 0 * lie, -0.3 * lie + 0 * side[None])


def _make_hood(
    surface: HeadSurface,
    neck: Neck,
    rng: np.random.Generator,
    measure: Callable[[Grid, Grid], Grid],
    loose: float,
    hang: float = 0.0,
) -> LabelledMesh:
    """Make cloth over head, neck and shoulders with an opening where `measure` is negative."""
    azimuth = np.linspace(-np.pi, np.pi, 161)[None]
    lowest = -0.92 - 0.2 * np.cos(azimuth)
    elevation = np.pi / 2 + (lowest - np.pi / 2) * np.linspace(0, 1, 90)[:, None]
    azimuth, elevation = np.broadcast_arrays(azimuth, elevation)
    off = 0.04 + loose
    outside = measure(azimuth, elevation)
    # The edge lies in the skin, so that nobody looks under the cloth.
    lift = 1 - np.exp(-outside.clip(0) / 0.12)
    room = (off + make_room_for_ears(azimuth, elevation)) * lift
    head = stretch(surface.place(azimuth, elevation), room - 0.015, 150, outside < 0.1)
    waves = sample_waves(rng, azimuth, elevation, (4.0, 3.0))
    head = move_out(head, loose * (1 - np.exp(-outside.clip(0) / 0.4)) * (1 + 0.7 * waves))
    # A veil falls from the nose, not along lips and chin.
    front = np.exp(-((azimuth / 0.75) ** 4))
    fall = 1 / (1 + np.exp((elevation + 0.62) / 0.09))
    head = move_out(head, hang * front * fall * (1 + 0.25 * waves))
    drape = _drape(head[-1], azimuth[0], neck, rng, 0.35 if loose else 0.05, hang)
    points = np.concatenate([head, drape])
    below = elevation[-1:] + np.linspace(-0.02, -1.0, len(drape))[:, None]
    heights = np.concatenate([elevation, below])
    azimuths = np.concatenate([azimuth, azimuth[:1] + 0 * below])
    hood = make_sheet(points, HEADWEAR, azimuths, heights)
    opening = measure(*hood.chart.T)
    return clip(hood, opening)


def _drape(
    ring: np.ndarray,
    azimuth: np.ndarray,
    neck: Neck,
    rng: np.random.Generator,
    spread: float,
    hang: float,
) -> Points:
    """Cloth that falls from a ring around the head over neck and shoulders, with folds."""
    share = np.linspace(0, 1, 40)[1:, None]
    low = -1.45 if spread < 0.1 else rng.uniform(-2.1, -1.7)
    loose = spread > 0.1
    # Near the neck it spreads fast: shoulders must not come through.
    wide = neck.half_width + 0.1 + 0.2 * loose + (spread + 0.8 * loose) * share**0.8
    deep = neck.half_depth + 0.08 + 0.14 * loose + (0.6 * spread + 0.3 * loose) * share**0.8
    folds = sample_waves(rng, azimuth[None], share, (9.0, 2.5)) * (0.01 + 0.12 * spread) * share
    x = neck.x + (wide + folds) * np.sin(azimuth)
    ahead = 1.6 * hang * np.exp(-((azimuth / 0.75) ** 4))
    z = neck.z + (deep + folds) * np.cos(azimuth) + ahead
    y = ring[:, 1] * (1 - share) + low * share
    blend = (1 - np.exp(-share / 0.12)) / (1 - np.exp(-1 / 0.12))
    return np.stack(
        [ring[:, 0] * (1 - blend) + x * blend, y, ring[:, 2] * (1 - blend) + z * blend], -1
    )
