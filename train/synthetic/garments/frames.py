"""Frames of glasses for synthetic heads."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    find_vertex,
    join,
    label_mesh,
    triangulate_grid,
)
from train.synthetic.labels import GLASSES

_AROUND = 9

_Line = Float[np.ndarray, "points 3"]


class Frame(NamedTuple):
    """Half axes of a rim, exponent of its outline, and radius of the wire, in half heads."""

    half_width: float
    half_height: float
    power: float
    radius: float


def place_rim(skin: LabelledMesh, eyes: Float[np.ndarray, "2 3"], frame: Frame) -> _Line:
    """Place the rim of the left eye in front of brows and cheeks."""
    half_width = min(frame.half_width, np.abs(eyes[:, 0]).mean() - 0.055)
    middle = np.abs(eyes).mean(0) * [1, 0, 0] + [0.015, eyes[:, 1].mean() - 0.02, 0]
    rim = middle + _trace_rim(half_width, frame.half_height, frame.power)
    rim[:, 2] = _find_front(skin, rim) - _bend_back(rim[:, 0])
    return np.asarray(rim)


def make_frame(skin: LabelledMesh, rim: _Line, frame: Frame) -> LabelledMesh:
    """Make rims, bridge and temples, given the rim of the left eye."""
    height, radius = frame.half_height, frame.radius
    middle = (rim[:, 1].min() + rim[:, 1].max()) / 2
    inner, outer = rim[rim[:, 0].argmin()], rim[rim[:, 0].argmax()]
    lines = [
        (rim, radius),
        (_trace_temple(skin, outer, middle + 0.4 * height), 0.8 * radius),
    ]
    both = [
        make_wire(line * side, wire) for line, wire in lines for side in ([1, 1, 1], [-1, 1, 1])
    ]
    return join([*both, make_wire(_trace_bridge(skin, inner, 0.3 * height), radius)])


def _trace_rim(half_width: float, half_height: float, power: float) -> _Line:
    angle = np.linspace(0, 2 * np.pi, 61)
    x, y = np.cos(angle), np.sin(angle)
    out = (np.abs(x) ** power + np.abs(y) ** power) ** (-1 / power)
    return np.stack([half_width * out * x, half_height * out * y, 0 * x], 1)


def _bend_back(x: Float[np.ndarray, "points"]) -> Float[np.ndarray, "points"]:
    """How far the front bends back, by the distance from the nose."""
    return np.asarray(0.28 * (np.abs(x) - 0.1).clip(0) ** 2)


def _find_front(skin: LabelledMesh, rim: _Line) -> float:
    """Depth at which the front clears brows and cheeks, though not the nose between the rims."""
    x, y = np.abs(skin.vertices[:, 0]), skin.vertices[:, 1]
    (left, low), (right, high) = rim[:, :2].min(0), rim[:, :2].max(0)
    under = (x > left + 0.02) & (x < right) & (y > low) & (y < high) & (skin.vertices[:, 2] > 0)
    return float((skin.vertices[under, 2] + _bend_back(x[under])).max() + 0.015)


def _trace_bridge(skin: LabelledMesh, inner: Float[np.ndarray, "3"], lift: float) -> _Line:
    x = np.linspace(-inner[0], inner[0], 21)
    arch = 1 - (x / inner[0]) ** 2
    y = inner[1] + lift * (0.6 + 0.4 * arch)
    near = (np.abs(skin.vertices[:, 0]) < inner[0]) & (
        np.abs(skin.vertices[:, 1] - y.mean()) < 0.05
    )
    nose = skin.vertices[near, 2].max() + 0.015
    return np.stack([x, y, inner[2] + (max(nose, inner[2]) - inner[2]) * arch], 1)


def _trace_temple(skin: LabelledMesh, outer: Float[np.ndarray, "3"], height: float) -> _Line:
    hinge, ear = find_vertex(skin, 1.15, 0.12), find_vertex(skin, 1.4, 0.12)
    share = np.linspace(0, 1, 15)[:, None]
    side = np.array([max(outer[0], hinge[0]) + 0.03, height, outer[2] - 0.04])
    end = np.array([max(side[0], ear[0]) + 0.01, max(ear[1], 0.05), ear[2] - 0.1])
    return np.concatenate(
        [outer[None] * [1, 0, 1] + [0, height, 0], side * (1 - share) + end * share]
    )


def make_wire(line: _Line, radius: float, label: int = GLASSES) -> LabelledMesh:
    """Make a round wire along a line."""
    along = np.gradient(line, axis=0)
    along = along / np.linalg.norm(along, axis=1, keepdims=True).clip(1e-9)
    upright = np.where(np.abs(along[:, 2:]) > 0.7, [[0.0, 1.0, 0.0]], [[0.0, 0.0, 1.0]])
    right = np.cross(along, upright)
    right = right / np.linalg.norm(right, axis=1, keepdims=True).clip(1e-9)
    up = np.cross(right, along)
    angle = np.linspace(0, 2 * np.pi, _AROUND)[:, None, None]
    points = line + radius * (np.cos(angle) * right + np.sin(angle) * up)
    count = _AROUND * len(line)
    return label_mesh(
        points.reshape(-1, 3), triangulate_grid(_AROUND, len(line)), label, np.zeros((count, 2))
    )
