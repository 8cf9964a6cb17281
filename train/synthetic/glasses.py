"""Frames of glasses before a synthetic head's eyes."""

import numpy as np
from jaxtyping import Float

from train.synthetic.labelled_mesh import Part, at, joined, part, sheet
from train.synthetic.labels import GLASSES

AROUND = 9

Line = Float[np.ndarray, "points 3"]


def glasses(skin: Part, eyes: Float[np.ndarray, "2 3"], draw: np.random.Generator) -> Part:
    """Two rims, the bridge and the temples; `eyes` are the foremost points of both."""
    wide, tall = draw.uniform(0.2, 0.26), draw.uniform(0.13, 0.2)
    power, thick = draw.uniform(2.0, 4.0), draw.uniform(0.008, 0.024)
    wide = min(wide, np.abs(eyes[:, 0]).mean() - 0.055)
    middle = np.abs(eyes).mean(0) * [1, 0, 0] + [0.015, eyes[:, 1].mean() - 0.02, 0]
    rim = middle + _outline(wide, tall, power)
    front = _plane(skin, rim)
    rim[:, 2] = front - _bow(rim[:, 0])
    inner, outer = rim[rim[:, 0].argmin()], rim[rim[:, 0].argmax()]
    lines = [(rim, thick), (_temple(skin, outer, middle[1] + 0.4 * tall), 0.8 * thick)]
    both = [_tube(line * side, wire) for line, wire in lines for side in ([1, 1, 1], [-1, 1, 1])]
    return joined([*both, _tube(_bridge(skin, inner, 0.3 * tall), thick)])


def _outline(wide: float, tall: float, power: float) -> Line:
    turn = np.linspace(0, 2 * np.pi, 61)
    x, y = np.cos(turn), np.sin(turn)
    out = (np.abs(x) ** power + np.abs(y) ** power) ** (-1 / power)
    return np.stack([wide * out * x, tall * out * y, 0 * x], 1)


def _bow(x: Float[np.ndarray, "points"]) -> Float[np.ndarray, "points"]:
    """How far a front bows back away from the nose."""
    return 0.28 * (np.abs(x) - 0.1).clip(0) ** 2


def _plane(skin: Part, rim: Line) -> float:
    """Where a front clears brows and cheeks under it, though not the nose between the rims."""
    x, y = np.abs(skin.vertices[:, 0]), skin.vertices[:, 1]
    (left, low), (right, high) = rim[:, :2].min(0), rim[:, :2].max(0)
    under = (x > left + 0.02) & (x < right) & (y > low) & (y < high) & (skin.vertices[:, 2] > 0)
    return float((skin.vertices[under, 2] + _bow(x[under])).max() + 0.015)


def _bridge(skin: Part, inner: Float[np.ndarray, "3"], lift: float) -> Line:
    x = np.linspace(-inner[0], inner[0], 21)
    arch = 1 - (x / inner[0]) ** 2
    y = inner[1] + lift * (0.6 + 0.4 * arch)
    near = (np.abs(skin.vertices[:, 0]) < inner[0]) & (
        np.abs(skin.vertices[:, 1] - y.mean()) < 0.05
    )
    nose = skin.vertices[near, 2].max() + 0.015
    return np.stack([x, y, inner[2] + (max(nose, inner[2]) - inner[2]) * arch], 1)


def _temple(skin: Part, outer: Float[np.ndarray, "3"], height: float) -> Line:
    hinge, ear = at(skin, 1.15, 0.12), at(skin, 1.4, 0.12)
    share = np.linspace(0, 1, 15)[:, None]
    side = np.array([max(outer[0], hinge[0]) + 0.03, height, outer[2] - 0.04])
    end = np.array([max(side[0], ear[0]) + 0.01, max(ear[1], 0.05), ear[2] - 0.1])
    return np.concatenate(
        [outer[None] * [1, 0, 1] + [0, height, 0], side * (1 - share) + end * share]
    )


def _tube(line: Line, radius: float) -> Part:
    """A round wire along a line."""
    along = np.gradient(line, axis=0)
    along = along / np.linalg.norm(along, axis=1, keepdims=True).clip(1e-9)
    help_ = np.where(np.abs(along[:, 2:]) > 0.7, [[0.0, 1.0, 0.0]], [[0.0, 0.0, 1.0]])
    right = np.cross(along, help_)
    right = right / np.linalg.norm(right, axis=1, keepdims=True).clip(1e-9)
    up = np.cross(right, along)
    turn = np.linspace(0, 2 * np.pi, AROUND)[:, None, None]
    points = line + radius * (np.cos(turn) * right + np.sin(turn) * up)
    count = AROUND * len(line)
    return part(points.reshape(-1, 3), sheet(AROUND, len(line)), GLASSES, np.zeros((count, 2)))
