"""A bald head from `skinnet.shape.procedural_head` with eyes, mouth and neck."""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.shape.procedural_head import CHART_EXTENT, IDENTITY_SIZE, compute_head_radius
from train.synthetic.body import Neck
from train.synthetic.labelled_mesh import Part, clipped, joined, part, sheet
from train.synthetic.labels import EYE, SKIN, TEETH

ROWS, COLUMNS, BACK = 168, 204, 24
EYE_AT, EYE_WIDE, IRIS = (0.34, 0.02), 0.135, 0.055
"""Places and sizes that paint around them counts on, in radians of the chart."""
MOUTH_AT, MOUTH_WIDE = -0.66, 0.19
LID, LIP = 0.016, 0.03
"""How far eyes and teeth lie behind the lids and the lips, in half heads."""

Grid = Float[np.ndarray, "rows columns"]


def bare_procedural(draw: np.random.Generator) -> tuple[Part, Neck]:
    """A head without hair, its eyes open and its mouth closed or smiling, and its neck."""
    identity = draw.normal(0, 1, IDENTITY_SIZE).clip(-2.5, 2.5)
    radius = compute_head_radius(torch.from_numpy(identity[None]), ROWS, COLUMNS)[0, 0].numpy()
    azimuth, elevation, radius = _closed(radius)
    eyes = _eyes(azimuth, elevation, draw.uniform(0.03, 0.06))
    smile = draw.choice([0.0, draw.uniform(0.02, 0.075)])
    mouth = _mouth(azimuth, elevation, smile) if smile else np.full_like(radius, -1.0)
    radius = radius - LID * _step(eyes) - LIP * _step(mouth)
    head = _mesh(azimuth, elevation, radius)
    eyes, mouth = eyes.ravel(), mouth.ravel()
    parts = [clipped(head, -np.maximum(eyes, mouth)), _looking(clipped(head, eyes, EYE), draw)]
    if smile:
        parts.append(clipped(head, mouth, TEETH))
    neck = Neck(0.0, -0.12, *(draw.uniform(0.36, 0.5) * np.array([1.0, 0.95])))
    return joined([*parts, _column(neck)]), neck


def _closed(radius: Grid) -> tuple[Grid, Grid, Grid]:
    """The chart with the back of the head and the poles, where it repeats its border."""
    azimuth = np.linspace(-CHART_EXTENT[0], CHART_EXTENT[0], COLUMNS)
    back = np.linspace(CHART_EXTENT[0], np.pi, BACK + 1)[1:]
    azimuth = np.concatenate([-back[::-1], azimuth, back])
    elevation = np.linspace(CHART_EXTENT[1], -CHART_EXTENT[1], ROWS)
    elevation = np.concatenate([[np.pi / 2], elevation, [-np.pi / 2]])
    radius = np.pad(radius, ((1, 1), (BACK, BACK)), "edge")
    radius[[0, -1]] = radius[[1, -2]].mean(1, keepdims=True)
    return *np.broadcast_arrays(azimuth[None], elevation[:, None]), radius


def _eyes(azimuth: Grid, elevation: Grid, height: float) -> Grid:
    across, up = np.abs(azimuth) - EYE_AT[0], elevation - EYE_AT[1]
    return 1 - (across / EYE_WIDE) ** 2 - (up / height) ** 2


def _mouth(azimuth: Grid, elevation: Grid, smile: float) -> Grid:
    up = elevation - MOUTH_AT - 0.25 * azimuth**2
    return 1 - (azimuth / MOUTH_WIDE) ** 2 - (up / smile) ** 2


def _step(value: Grid) -> Grid:
    return 1 / (1 + np.exp(-(value / 0.15).clip(-40, 40)))


def _mesh(azimuth: Grid, elevation: Grid, radius: Grid) -> Part:
    x, z = np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation)
    points = radius[..., None] * np.stack([x, np.sin(elevation), z], -1)
    places = np.stack([azimuth, elevation], -1)
    return part(points.reshape(-1, 3), sheet(*radius.shape), SKIN, places.reshape(-1, 2))


def _looking(eyes: Part, draw: np.random.Generator) -> Part:
    """The eyes with their chart about where they look."""
    gaze = draw.normal(0, (0.03, 0.012)).clip(-0.06, 0.06)
    middle = np.sign(eyes.chart[:, :1]) * [EYE_AT[0], 0] + [0, EYE_AT[1]]
    return eyes._replace(chart=(eyes.chart - middle - gaze) / IRIS)


def _column(neck: Neck) -> Part:
    turn, y = np.meshgrid(np.linspace(-np.pi, np.pi, 73), np.linspace(-0.45, -1.7, 26))
    swell = 1 + 0.15 * (y + 1.0) ** 2
    x = neck.x + neck.wide * swell * np.sin(turn)
    z = neck.z - 0.12 * (-0.5 - y).clip(0) + neck.deep * swell * np.cos(turn)
    chart = np.stack([turn, -1.25 - 0.4 * (-1.02 - y).clip(0)], -1)
    points = np.stack([x, y, z], -1)
    return part(points.reshape(-1, 3), sheet(*x.shape), SKIN, chart.reshape(-1, 2))
