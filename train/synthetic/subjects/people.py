"""People of the variety `any`: heads with bodies, arms and hands, alone or in groups."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.arms import hang_arm, make_arm, make_legs, raise_arm, sample_sleeve
from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, label_mesh, triangulate_grid
from train.synthetic.bodies.limbs import Vector
from train.synthetic.labels import CLOTH, MATERIALS
from train.synthetic.subjects.framing import MAX_ANGLES, Framing, rotate, sample_angles

MakeHead = Callable[[np.random.Generator], LabelledMesh]

HAND_SHARE = 0.25
"""Share of faces with a hand before them; one in five of these has both hands there."""

_GROUP_HAND_SHARE = 0.1
_PALM_SHARE = 0.3

_TARGETS = ((0.0, -0.95), (0.0, -0.55), (0.35, -0.45), (0.5, -0.1), (0.3, 0.1), (0.3, 0.55),
            (0.75, 0.2))  # fmt: skip
"""Where the middle of a hand may be, to the side of the face and up."""

_WAIST, _HIPS = -3.4, -6.6


class Placement(NamedTuple):
    """Where one of a group stands: pitch, yaw and roll in radians, and the place of the eyes."""

    angles: Float[np.ndarray, "3"]
    place: Vector


def make_person(
    head: LabelledMesh, rng: np.random.Generator, hand_share: float = HAND_SHARE
) -> LabelledMesh:
    """Complete a head with a body, arms and hands.

    Args:
        head: A head with its bust.
        rng: Random numbers.
        hand_share: Share of people with a hand before the face.

    Returns:
        The person.
    """
    half_width, half_depth, z = _measure_waist(head)
    parts = [
        head,
        _make_hips(half_width, half_depth, z),
        make_legs(0.5 * half_width, _HIPS + 1.5, z),
    ]
    sleeve, raised = sample_sleeve(rng), rng.random() < hand_share
    first = rng.choice([-1, 1])
    for side in (first, -first):
        shoulder = np.array([side * (half_width - 0.32), -2.2, z])
        arm = (
            raise_arm(
                shoulder, _find_target(head, side, rng), rng, sleeve, rng.random() < _PALM_SHARE
            )
            if raised
            else hang_arm(shoulder, rng, sleeve)
        )
        parts.append(make_arm(arm, rng))
        raised = raised and rng.random() < 0.2
    return join(parts)


def _measure_waist(head: LabelledMesh) -> tuple[float, float, float]:
    """Half axes of the bust where it ends, and the depth of its middle."""
    cloth = head.vertices[np.unique(head.triangles[head.label == CLOTH])]
    ring = cloth[cloth[:, 1] < _WAIST]
    low, high = ring.min(0), ring.max(0)
    half_width, _, half_depth = (high - low) / 2
    return float(half_width), float(half_depth), float((low + high)[2] / 2)


def _make_hips(half_width: float, half_depth: float, z: float) -> LabelledMesh:
    angle, y = np.meshgrid(np.linspace(-np.pi, np.pi, 65), np.linspace(_WAIST, _HIPS, 12))
    shape = 1 - 0.08 * np.sin(np.pi * (y - _WAIST) / (_HIPS - _WAIST))
    points = np.stack(
        [half_width * shape * np.sin(angle), y, z + half_depth * shape * np.cos(angle)], -1
    ).reshape(-1, 3)
    return label_mesh(points, triangulate_grid(*angle.shape), CLOTH, points[:, :2])


def _find_target(head: LabelledMesh, side: int, rng: np.random.Generator) -> Vector:
    """A place just before the face, mostly on the side of the arm."""
    x, y = _TARGETS[rng.integers(len(_TARGETS))]
    x *= side * (1 if rng.random() < 0.8 else -1)
    place = np.array([x, y]) + rng.normal(0, 0.1, 2)
    near = np.hypot(*(head.vertices[:, :2] - place).T) < 0.5
    near &= head.vertices[:, 1] > -1.3
    return np.array([*place, head.vertices[near, 2].max() + 0.15])


def sample_group(rng: np.random.Generator) -> tuple[list[Placement], Framing]:
    """Sample where two to four people stand, and a camera that sees them.

    Neighbours are 1.6 to 2.9 half heads apart and differ in depth, so that the nearer one hides the
    farther one. One group in four has a person far behind.

    Args:
        rng: Random numbers.

    Returns:
        Their places, and the framing of the origin.
    """
    count = int(rng.choice((2, 3, 4), p=(0.5, 0.3, 0.2)))
    x = np.cumsum(rng.uniform(1.6, 2.9, count))
    y = rng.normal(0, 0.45, count)
    z = rng.uniform(0.5, 1.4, count) * (-1.0) ** (np.arange(count) + rng.integers(2))
    if rng.random() < 0.25:
        z[rng.integers(count)] -= rng.uniform(4, 9)
    places = np.stack([x - (x.min() + x.max()) / 2, y - y.mean(), z], 1)
    angles = [sample_angles(rng) * (0.8, 0.7, 0.5) for _ in range(count)]
    half = max(np.ptp(places[:, 0]), np.ptp(places[:, 1])) / 2 + 1.3
    camera = rng.normal(0, (0.08, 0.1, 0.12)).clip(-MAX_ANGLES, MAX_ANGLES)
    framing = Framing(
        camera,
        float(rng.uniform(0.8, 1.4) / half),
        rng.normal(0, 0.12, 2).clip(-0.3, 0.3),
        rng.uniform(9.0, 20.0),
        bool(rng.random() < 0.1),
    )
    return [Placement(*pair) for pair in zip(angles, places, strict=True)], framing


def make_group(
    placements: list[Placement], make_head: MakeHead, rng: np.random.Generator
) -> LabelledMesh:
    """Make the people of a group, whose labels have the numbers of their paintings.

    Args:
        placements: Where they stand.
        make_head: Makes a head with its bust.
        rng: Random numbers.

    Returns:
        All of them.
    """
    people = []
    for number, (angles, place) in enumerate(placements):
        person = make_person(make_head(rng), rng, _GROUP_HAND_SHARE)
        label = (person.label + MATERIALS * number).astype(np.uint8)
        vertices = person.vertices @ rotate(angles).T + place
        people.append(person._replace(vertices=vertices, label=label))
    return join(people)
