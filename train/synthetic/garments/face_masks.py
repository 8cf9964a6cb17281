"""Masks over nose and mouth: surgical masks with pleats, folded N95 shapes, and cloth."""

from typing import NamedTuple

import numpy as np

from train.synthetic.bodies.labelled_mesh import LabelledMesh, join
from train.synthetic.bodies.shell import (
    Grid,
    HeadSurface,
    Points,
    make_sheet,
    move_out,
    sample_waves,
    stretch,
)
from train.synthetic.garments.frames import make_wire
from train.synthetic.labels import FACE_MASK

_ROWS, _COLUMNS = 61, 81

KINDS = ("surgical", "N95", "cloth")
_KIND_SHARES = (0.5, 0.25, 0.25)

_TOPS = (-0.14, -0.53, -0.86)
"""Elevation of the upper edge on the middle line: worn right, below the nose, under the lips."""
_TOP_SHARES = (0.72, 0.2, 0.08)


class _Outline(NamedTuple):
    """Half width in radians, and how far each edge lies below `_TOPS` and the chin."""

    half_width: float
    top: float
    sag: float
    chin: float


def make_face_mask(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a mask with ear loops.

    Half are surgical masks; 72 % are worn right, 20 % below the nose, 8 % below the lips.

    Args:
        surface: The head's skin.
        rng: Random numbers.

    Returns:
        Cloth and loops.
    """
    kind = KINDS[rng.choice(len(KINDS), p=_KIND_SHARES)]
    outline = _Outline(
        rng.uniform(0.95, 1.15),
        _TOPS[rng.choice(len(_TOPS), p=_TOP_SHARES)] + rng.normal(0, 0.03),
        rng.uniform(0.12, 0.24),
        rng.uniform(-1.21, -1.1),
    )
    across, down = np.meshgrid(np.linspace(-1, 1, _COLUMNS), np.linspace(0, 1, _ROWS))
    azimuth, elevation = _place_cloth(outline, across, down)
    points = stretch(surface.place(azimuth, elevation), 0.02, 600)
    points = move_out(points, _raise_cloth(kind, across, down, rng).clip(-0.012))
    cloth = make_sheet(points, FACE_MASK, across, 1 - 2 * down)
    return join([cloth, *_make_loops(surface, points, azimuth, elevation)])


def _place_cloth(outline: _Outline, across: Grid, down: Grid) -> tuple[Grid, Grid]:
    """Places on the chart: the upper edge sinks beside the nose, the lower one rises to the jaw."""
    beside = 1 - np.exp(-((across / 0.28) ** 2))
    top = outline.top - outline.sag * beside * (outline.top > -0.4)
    bottom = outline.chin + 0.42 * np.abs(across) ** 2.2
    top = np.maximum(top - 0.1 * np.abs(across) ** 4, bottom + 0.12)
    return outline.half_width * across, top + (bottom - top) * down


def _raise_cloth(kind: str, across: Grid, down: Grid, rng: np.random.Generator) -> Grid:
    """Pleats, a cup or a seam, and wrinkles that grow towards the sides."""
    inside = (1 - across**2) * (1 - (2 * down - 1) ** 2)
    wrinkles = sample_waves(rng, across, down, (7.0, 16.0))
    raised = 0.008 * wrinkles * (0.25 + np.abs(across)) * np.minimum(1, 6 * inside + 0.15)
    if kind == "surgical":
        pleats = (3.0 * (1.25 * down - 0.12)).clip(0, 3)
        raised += 0.03 * (pleats % 1) ** 1.5 * (1 - across**6) * (down > 0.1)
        return np.asarray(raised + 0.03 * inside)
    if kind == "N95":
        seam = np.exp(-((np.abs(down - 0.45) / 0.025) ** 2))
        return np.asarray(0.4 * raised + rng.uniform(0.12, 0.2) * inside**0.7 + 0.012 * seam)
    seam = np.exp(-((across / 0.03) ** 2)) * (1 - (2 * down - 1) ** 4)
    return np.asarray(1.3 * raised + rng.uniform(0.03, 0.1) * inside + 0.012 * seam)


def _make_loops(
    surface: HeadSurface, points: Points, azimuth: Grid, elevation: Grid
) -> list[LabelledMesh]:
    """Loops from the four corners to the ears."""
    loops, share = [], np.linspace(0, 1, 15)[:, None]
    for row, ear in ((2, 0.1), (-3, -0.26)):
        for column, side in ((1, -1.0), (-2, 1.0)):
            first = azimuth[row, column], elevation[row, column]
            line = surface.place(
                first[0] + (side * 1.52 - first[0]) * share, first[1] + (ear - first[1]) * share
            )
            line = move_out(line, np.full(line.shape[:2], 0.012))[:, 0]
            line[0] = points[row, column]
            loops.append(make_wire(_tighten(line), 0.009, FACE_MASK))
    return loops


def _tighten(line: np.ndarray) -> np.ndarray:
    """Draw a thread straight where it does not lie on the skin."""
    length = np.linalg.norm(line, axis=1, keepdims=True)
    straight = line[0] + (line[-1] - line[0]) * np.linspace(0, 1, len(line))[:, None]
    reach = np.linalg.norm(straight, axis=1, keepdims=True)
    return np.asarray(np.where(reach > length, straight, line))
