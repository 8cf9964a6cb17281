"""Hands: a palm and five fingers with nails.

In its own axes a hand starts at the wrist and points up, with its back ahead. It is the right hand,
so that its thumb is at negative x; `mirror` makes the left one.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.labelled_mesh import LabelledMesh, join
from train.synthetic.bodies.limbs import Tube, bend_line, make_tube
from train.synthetic.labels import NAIL, SKIN

_BASES = ((-0.26, 0.80), (-0.088, 0.85), (0.085, 0.82), (0.25, 0.73))
_LENGTHS = (0.64, 0.72, 0.67, 0.52)
_RADII = (0.096, 0.100, 0.094, 0.082)
_SPREAD = (0.9, 0.25, -0.35, -1.0)
_PHALANGES = (0.46, 0.29, 0.25)
_POINTS = 24


class Pose(NamedTuple):
    """How a hand is held: flexion of a finger's three joints, spread, and that of the thumb."""

    flexion: Float[np.ndarray, "fingers joints"]
    spread: float
    thumb: float


def sample_pose(rng: np.random.Generator) -> Pose:
    """Sample a pose: mostly a relaxed or flat hand, at times a fist or a pointing finger."""
    base = rng.choice(3, p=(0.45, 0.4, 0.15))
    joints = np.array([(0.08, 0.06, 0.03), (0.35, 0.5, 0.3), (1.35, 1.6, 0.8)])[base]
    flexion = joints * rng.uniform(0.7, 1.3) * rng.uniform(0.85, 1.15, (4, 3))
    if base == 2 and rng.random() < 0.5:
        flexion[0] = rng.uniform(0, 0.2, 3)
    spread = rng.uniform(0.0, 0.22) if base < 2 else 0.02
    return Pose(flexion, spread, rng.uniform(0.1, 0.5) + 0.5 * (base == 2))


def make_hand(pose: Pose) -> LabelledMesh:
    """Make a right hand.

    Args:
        pose: How it is held.

    Returns:
        Skin and nails, in half heads.
    """
    fingers = [_make_finger(number, pose) for number in range(4)]
    return join([_make_palm(), *fingers, _make_thumb(pose.thumb)])


def _make_palm() -> LabelledMesh:
    y = np.linspace(0.0, 0.76, _POINTS)
    share = y / 0.76
    width = np.interp(share, (0, 0.25, 0.6, 1), (0.235, 0.29, 0.355, 0.35))
    depth = np.interp(share, (0, 0.3, 0.7, 1), (0.165, 0.165, 0.14, 0.105))
    line = np.stack([0.0 * y, y, 0.03 * np.sin(np.pi * share)], 1)
    back = np.tile([0.0, 0.0, 1.0], (_POINTS, 1))
    return make_tube(Tube(line, back, width, depth, 0.05 + 0.4 * share), SKIN)


def _make_finger(number: int, pose: Pose) -> LabelledMesh:
    base = np.array([*_BASES[number], 0.0])
    base[1] -= 0.12
    lean = -_SPREAD[number] * (pose.spread + 0.04)
    bend = np.cumsum(pose.flexion[number])
    steps = np.array(_PHALANGES) * _LENGTHS[number]
    up = np.stack([np.sin(lean) * np.cos(bend), np.cos(lean) * np.cos(bend), -np.sin(bend)], 1)
    first = base + 0.12 * np.array([np.sin(lean), np.cos(lean), 0])
    corners = np.concatenate([base[None], first[None], first + np.cumsum(steps[:, None] * up, 0)])
    return _make_digit(corners, _RADII[number], 0.5, 1.08, np.array([0.0, 0, 1]))


def _make_thumb(flexion: float) -> LabelledMesh:
    directions = np.array(
        [
            [-0.62, 0.72, -0.3],
            [-0.5, 0.85, -0.25 - 0.3 * flexion],
            [-0.3, 0.95, -0.2 - 0.6 * flexion],
        ]
    )
    directions[1:, 0] += 0.5 * flexion
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    start = np.array([[-0.04, 0.10, 0.03]])
    steps = np.array([0.52, 0.30, 0.26])[:, None] * directions
    corners = np.concatenate([start, start + np.cumsum(steps, 0)])
    return _make_digit(corners, 0.12, 0.7, 0.6, np.array([-0.75, -0.3, 0.6]))


def _make_digit(
    corners: Float[np.ndarray, "corners 3"],
    radius: float,
    along: float,
    root: float,
    hint: Float[np.ndarray, "3"],
) -> LabelledMesh:
    """A finger that tapers, thicker at its joints, with a nail on its back."""
    line = bend_line(corners, _POINTS, 0.12)
    share = np.linspace(0, 1, _POINTS)
    taper = np.interp(share, (0, 0.25, 0.75, 1), (root, 1.0, 0.9, 0.78))
    back = _lift_back(line, hint)
    tube = Tube(line, back, radius * taper, 0.93 * radius * taper, along + share * (1.45 - along))
    return _label_nail(make_tube(tube, SKIN), along)


def _label_nail(digit: LabelledMesh, along: float) -> LabelledMesh:
    # Both triangles of a cell lie half a list apart.
    cells = digit.chart[digit.triangles].mean(1).reshape(2, -1, 2).mean(0)
    azimuth, elevation = np.tile(cells, (2, 1)).T
    share = (elevation - along) / (1.45 - along)
    nail = (np.abs(azimuth) < 0.45) & (share > 0.82) & (share < 0.999)
    return digit._replace(label=np.where(nail, NAIL, digit.label).astype(np.uint8))


def _lift_back(line: Float[np.ndarray, "points 3"], hint: Float[np.ndarray, "3"]) -> np.ndarray:
    """Carry the direction of a finger's back along its line."""
    tangent = np.gradient(line, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    back = [hint]
    for one in tangent:
        across = back[-1] - (back[-1] @ one) * one
        back.append(across / np.linalg.norm(across))
    return np.array(back[1:])
