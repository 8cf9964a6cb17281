"""Bald heads of `skinnet.shape._procedural_head`, with eyes, mouth and neck."""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.shape._procedural_head import CHART_EXTENT, IDENTITY_SIZE, compute_head_radius
from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.expression import OPEN_MOUTH_SHARE
from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    clip,
    join,
    label_mesh,
    triangulate_grid,
)
from train.synthetic.labels import EYE, SKIN, TEETH
from train.synthetic.variety import Variety

_ROWS, _COLUMNS, _BACK = 168, 204, 24
_EYE_PLACE, _EYE_HALF_WIDTH, _IRIS_RADIUS = (0.34, 0.02), 0.135, 0.055
"""Radians on the chart; `train.synthetic.painting.facial_hair` paints around them."""
_MOUTH_ELEVATION, _MOUTH_HALF_WIDTH = -0.66, 0.19
_LID, _LIP = 0.016, 0.03
"""Depth of eyes and teeth behind eyelids and lips, in half heads."""

_SMILES: dict[Variety, tuple[float, float] | None] = {
    "mild": None, "any": (1 - OPEN_MOUTH_SHARE, OPEN_MOUTH_SHARE),
}  # fmt: skip
"""Probabilities of closed mouths and of smiles. None is half of each, and does not change the
random numbers of earlier versions."""

_Grid = Float[np.ndarray, "rows columns"]


def make_bald_procedural(
    rng: np.random.Generator, variety: Variety = "mild"
) -> tuple[LabelledMesh, Neck]:
    """Make a bald head, its eyes open and its mouth closed or smiling.

    Args:
        rng: Random numbers.
        variety: `mild` lets half of them smile, `any` a share `OPEN_MOUTH_SHARE`.

    Returns:
        The head, and where its neck ends.
    """
    identity = rng.normal(0, 1, IDENTITY_SIZE).clip(-2.5, 2.5)
    radius = compute_head_radius(torch.from_numpy(identity[None]), _ROWS, _COLUMNS)[0, 0].numpy()
    azimuth, elevation, radius = _extend_to_back(radius)
    eyes = _measure_eyes(azimuth, elevation, rng.uniform(0.03, 0.06))
    smile = rng.choice([0.0, rng.uniform(0.02, 0.075)], p=_SMILES[variety])
    mouth = _measure_mouth(azimuth, elevation, smile) if smile else np.full_like(radius, -1.0)
    radius = radius - _LID * _step_smoothly(eyes) - _LIP * _step_smoothly(mouth)
    head = _make_skin(azimuth, elevation, radius)
    eyes, mouth = eyes.ravel(), mouth.ravel()
    parts = [clip(head, -np.maximum(eyes, mouth)), _aim_eyes(clip(head, eyes, EYE), rng)]
    if smile:
        parts.append(clip(head, mouth, TEETH))
    neck = Neck(0.0, -0.12, *(rng.uniform(0.36, 0.5) * np.array([1.0, 0.95])))
    return join([*parts, _make_neck(neck)]), neck


def _extend_to_back(radius: _Grid) -> tuple[_Grid, _Grid, _Grid]:
    """Extend the chart to the back of the head and the poles by the values of its border."""
    azimuth = np.linspace(-CHART_EXTENT[0], CHART_EXTENT[0], _COLUMNS)
    back = np.linspace(CHART_EXTENT[0], np.pi, _BACK + 1)[1:]
    azimuth = np.concatenate([-back[::-1], azimuth, back])
    elevation = np.linspace(CHART_EXTENT[1], -CHART_EXTENT[1], _ROWS)
    elevation = np.concatenate([[np.pi / 2], elevation, [-np.pi / 2]])
    radius = np.pad(radius, ((1, 1), (_BACK, _BACK)), "edge")
    radius[[0, -1]] = radius[[1, -2]].mean(1, keepdims=True)
    azimuths, elevations = np.broadcast_arrays(azimuth[None], elevation[:, None])
    return azimuths, elevations, radius


def _measure_eyes(azimuth: _Grid, elevation: _Grid, height: float) -> _Grid:
    across, up = np.abs(azimuth) - _EYE_PLACE[0], elevation - _EYE_PLACE[1]
    return np.asarray(1 - (across / _EYE_HALF_WIDTH) ** 2 - (up / height) ** 2)


def _measure_mouth(azimuth: _Grid, elevation: _Grid, smile: float) -> _Grid:
    up = elevation - _MOUTH_ELEVATION - 0.25 * azimuth**2
    return np.asarray(1 - (azimuth / _MOUTH_HALF_WIDTH) ** 2 - (up / smile) ** 2)


def _step_smoothly(value: _Grid) -> _Grid:
    return np.asarray(1 / (1 + np.exp(-(value / 0.15).clip(-40, 40))))


def _make_skin(azimuth: _Grid, elevation: _Grid, radius: _Grid) -> LabelledMesh:
    x, z = np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation)
    points = radius[..., None] * np.stack([x, np.sin(elevation), z], -1)
    places = np.stack([azimuth, elevation], -1)
    return label_mesh(
        points.reshape(-1, 3), triangulate_grid(*radius.shape), SKIN, places.reshape(-1, 2)
    )


def _aim_eyes(eyes: LabelledMesh, rng: np.random.Generator) -> LabelledMesh:
    """Centre the chart of the eyes on a random gaze."""
    gaze = rng.normal(0, (0.03, 0.012)).clip(-0.06, 0.06)
    middle = np.sign(eyes.chart[:, :1]) * [_EYE_PLACE[0], 0] + [0, _EYE_PLACE[1]]
    return eyes._replace(chart=(eyes.chart - middle - gaze) / _IRIS_RADIUS)


def _make_neck(neck: Neck) -> LabelledMesh:
    azimuth, y = np.meshgrid(np.linspace(-np.pi, np.pi, 73), np.linspace(-0.45, -1.7, 26))
    swell = 1 + 0.15 * (y + 1.0) ** 2
    x = neck.x + neck.half_width * swell * np.sin(azimuth)
    z = neck.z - 0.12 * (-0.5 - y).clip(0) + neck.half_depth * swell * np.cos(azimuth)
    chart = np.stack([azimuth, -1.25 - 0.4 * (-1.02 - y).clip(0)], -1)
    points = np.stack([x, y, z], -1)
    return label_mesh(points.reshape(-1, 3), triangulate_grid(*x.shape), SKIN, chart.reshape(-1, 2))
