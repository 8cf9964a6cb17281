"""Arms with hands and sleeves, and legs."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.hands import make_hand, sample_pose
from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, mirror
from train.synthetic.bodies.limbs import Points, Tube, Vector, bend_line, find_elbow, make_tube
from train.synthetic.labels import BODY, CLOTH, MATERIALS, SKIN

LENGTHS = (2.6, 2.25)
"""Of upper arm and forearm, in half heads of 11.5 cm."""

_POINTS = 40
_SHARES = (0, 0.2, 0.45, 0.51, 0.62, 0.92, 1)
_WIDTHS = (0.46, 0.46, 0.38, 0.36, 0.38, 0.235, 0.24)
_DEPTHS = (0.48, 0.46, 0.38, 0.35, 0.36, 0.165, 0.14)
"""Half axes of an arm at shares of its length."""

_CHART = ((0, 0.5, 1), (-1.45, -1.2, 0.1))
"""Shares of an arm's length, and elevations on its chart, most of which is the forearm's."""


class Arm(NamedTuple):
    """An arm and what it wears.

    `axes` are those of the hand in rows: side, along and back. `sleeve` is the share of the arm
    that is covered, from the shoulder on.
    """

    shoulder: Vector
    elbow: Vector
    wrist: Vector
    axes: Float[np.ndarray, "3 3"]
    left: bool
    sleeve: float
    thickness: float


def sample_sleeve(rng: np.random.Generator) -> float:
    """Sample the share of an arm that a sleeve covers: long, short or none."""
    return float(
        rng.choice([rng.uniform(0.85, 0.97), rng.uniform(0.2, 0.5), 0.06], p=(0.5, 0.35, 0.15))
    )


def make_arm(arm: Arm, rng: np.random.Generator) -> LabelledMesh:
    """Make an arm with its hand.

    Args:
        arm: Where it is.
        rng: Random numbers.

    Returns:
        Skin with numbers of a body, nails and a sleeve.
    """
    share = np.linspace(0, 1, _POINTS)
    # The forearm ends within the palm, so that the wrist has no seam.
    end = arm.wrist + 0.3 * arm.axes[1]
    line = bend_line(np.stack([arm.shoulder, arm.elbow, arm.wrist, end]), _POINTS, 0.12)
    width, depth = (
        arm.thickness * np.interp(share, _SHARES, radii) for radii in (_WIDTHS, _DEPTHS)
    )
    skin = Tube(line, _turn_back(line, arm), width, depth, np.interp(share, *_CHART))
    hand = make_hand(sample_pose(rng))
    hand = mirror(hand) if arm.left else hand
    hand = hand._replace(vertices=arm.thickness * hand.vertices @ arm.axes + arm.wrist)
    bare = number_body(join([make_tube(skin, SKIN), hand]))
    return join([bare, _make_sleeve(skin, arm.sleeve, rng)])


def _turn_back(line: Points, arm: Arm) -> Points:
    """The back of the forearm is that of the hand; that of the upper arm looks away from it."""
    out = arm.elbow - (arm.shoulder + arm.wrist) / 2
    share = np.linspace(0, 1, len(line))[:, None].clip(0.5) * 2 - 1
    return np.asarray(
        (1 - share) * out / max(float(np.linalg.norm(out)), 1e-6) + share * arm.axes[2]
    )


def _make_sleeve(skin: Tube, sleeve: float, rng: np.random.Generator) -> LabelledMesh:
    last = max(int(sleeve * _POINTS), 2)
    room = 0.03 + rng.uniform(0, 0.12) * np.linspace(0.3, 1, last)
    along = np.zeros(last)
    cut = Tube(*(one[:last] for one in skin))
    cloth = make_tube(Tube(cut.line, cut.back, cut.width + room, cut.depth + room, along), CLOTH)
    # Beside the collar and the tie of the clothes' chart.
    return cloth._replace(chart=cloth.vertices[:, :2] + [3.0, 0.0])


def number_body(mesh: LabelledMesh) -> LabelledMesh:
    """Give all labels the number of a body's painting."""
    return mesh._replace(label=(mesh.label + MATERIALS * BODY).astype(np.uint8))


def aim_hand(along: Vector, back: Vector) -> Float[np.ndarray, "3 3"]:
    """Make the axes of a hand from the direction of its fingers and about that of its back."""
    y = along / np.linalg.norm(along)
    z = back - (back @ y) * y
    z /= np.linalg.norm(z)
    return np.stack([np.cross(y, z), y, z])


def raise_arm(
    shoulder: Vector, target: Vector, rng: np.random.Generator, sleeve: float, palm: bool
) -> Arm:
    """Hold a hand before a place on the face.

    Args:
        shoulder: Where the arm starts; its sign of x tells left from right.
        target: Where the middle of the hand is.
        rng: Random numbers.
        sleeve: Share of the arm that is covered.
        palm: Whether the palm looks ahead, otherwise the back.

    Returns:
        The arm.
    """
    left = shoulder[0] > 0
    outwards = 1.0 if left else -1.0
    # The forearm comes from below and from its own side.
    angle = rng.normal(0.5, 0.35)
    along = np.array([-outwards * np.sin(angle), np.cos(angle), rng.normal(0.1, 0.15)])
    facing = np.array([rng.normal(0, 0.25), 0.0, -1.0 if palm else 1.0])
    axes = aim_hand(along, facing)
    wrist = target - 0.75 * axes[1]
    pole = np.array([outwards * rng.uniform(0.2, 1.2), -1.0, rng.uniform(0, 0.6)])
    elbow = find_elbow(shoulder, wrist, LENGTHS, pole)
    return Arm(shoulder, elbow, wrist, axes, left, sleeve, rng.uniform(0.8, 1.05))


def hang_arm(shoulder: Vector, rng: np.random.Generator, sleeve: float) -> Arm:
    """Let an arm hang down beside the body."""
    left = shoulder[0] > 0
    outwards = 1.0 if left else -1.0
    wrist = shoulder + [outwards * rng.uniform(0.1, 0.7), -4.6, rng.uniform(0.0, 0.6)]
    elbow = find_elbow(shoulder, wrist, LENGTHS, np.array([outwards, 0, -0.6]))
    axes = aim_hand(np.array([0.0, -1.0, 0.1]), np.array([outwards, 0.0, 0.4]))
    return Arm(shoulder, elbow, wrist, axes, left, sleeve, rng.uniform(0.8, 1.05))


def make_legs(x: float, top: float, z: float) -> LabelledMesh:
    """Make both legs in cloth, longer than any picture shows."""
    count = 12
    y = np.linspace(top, -20, count)
    legs = [
        make_tube(
            Tube(
                np.stack([0 * y + side * x, y, 0 * y + z], 1),
                np.tile([0.0, 0, 1], (count, 1)),
                np.linspace(0.66, 0.45, count),
                np.linspace(0.5, 0.42, count),
                0 * y,
            ),
            CLOTH,
        )
        for side in (-1, 1)
    ]
    both = join(legs)
    return both._replace(chart=both.vertices[:, :2] + [6.0, 0.0])
