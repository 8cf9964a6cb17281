"""Skin without a face: forearms, hands, patches that fill the picture, and cheeks close up."""

from typing import NamedTuple

import numpy as np

from train.synthetic.bodies.arms import Arm, aim_hand, make_arm, number_body
from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    find_vertex,
    label_mesh,
    triangulate_grid,
)
from train.synthetic.bodies.limbs import Vector
from train.synthetic.labels import SKIN
from train.synthetic.subjects.framing import Framing, sample_angles
from train.synthetic.subjects.people import MakeHead

SUBJECTS = {"forearm": 0.35, "hand": 0.3, "patch": 0.2, "cheek": 0.15}
"""Shares of what pictures of skin show. A cheek or forehead is that of a face, seen so close that
neither eyes nor mouth are in the picture."""

_CLOSE_UPS = ((0.85, -0.4), (0.95, -0.3), (0.0, 0.6), (1.1, -0.35))


class Shot(NamedTuple):
    """A mesh, and the framing of a point of it."""

    mesh: LabelledMesh
    point: Vector
    framing: Framing


def make_skin_scene(make_head: MakeHead, rng: np.random.Generator) -> Shot:
    """Make a picture of skin without a face, with the shares of `SUBJECTS`.

    Args:
        make_head: Makes a head with its bust.
        rng: Random numbers.

    Returns:
        What is seen, and how.
    """
    subject = list(SUBJECTS)[rng.choice(len(SUBJECTS), p=list(SUBJECTS.values()))]
    if subject == "cheek":
        return _make_close_up(make_head(rng), rng)
    if subject == "patch":
        mesh = number_body(_make_patch(rng))
        angles = rng.normal(0, (0.25, 0.25, 0.0)).clip(-0.5, 0.5)
        return Shot(mesh, np.zeros(3), _frame(rng, angles, (0.8, 1.6)))
    mesh = _make_lone_arm(rng)
    angles = np.array([rng.normal(0, 0.3), *rng.uniform(-np.pi, np.pi, 2)])
    if subject == "hand":
        return Shot(mesh, np.array([0, 0.7, 0.0]), _frame(rng, angles, (0.55, 1.3)))
    middle = np.array([0.0, -rng.uniform(0.5, 1.6), 0.0])
    return Shot(mesh, middle, _frame(rng, angles, (0.6, 2.6)))


def _frame(
    rng: np.random.Generator, angles: Vector, zooms: tuple[float, float], off: float = 0.2
) -> Framing:
    zoom = float(np.exp(rng.uniform(*np.log(zooms))))
    return Framing(
        angles, zoom, rng.uniform(-off, off, 2), rng.uniform(7, 20), bool(rng.random() < 0.3)
    )


def _make_lone_arm(rng: np.random.Generator) -> LabelledMesh:
    """An arm along y with the wrist at the origin, bent at the elbow."""
    bend, side = rng.uniform(0.1, 0.9), rng.normal(0, 0.2)
    elbow = np.array([0.0, -2.25, 0.0])
    shoulder = elbow + 2.6 * np.array([np.sin(side), -np.cos(bend), -np.sin(bend)])
    along = np.array([rng.normal(0, 0.2), 1.0, rng.normal(0, 0.3)])
    axes = aim_hand(along, np.array([0.0, 0.0, 1.0]))
    sleeve = float(rng.choice([0.06, rng.uniform(0.3, 0.75)], p=(0.6, 0.4)))
    arm = Arm(
        shoulder, elbow, np.zeros(3), axes, bool(rng.random() < 0.5), sleeve, rng.uniform(0.8, 1.2)
    )
    return make_arm(arm, rng)


def _make_patch(rng: np.random.Generator) -> LabelledMesh:
    """A curved surface that is larger than the picture."""
    x, y = np.meshgrid(np.linspace(-2.4, 2.4, 121), np.linspace(2.4, -2.4, 121))
    bends = rng.uniform((-0.05, -0.05), (0.7, 0.35))
    z = -(bends[0] * x**2 + bends[1] * y**2) / 2
    wave, phase = rng.normal(0, 1.5, (2, 6)), rng.uniform(0, 2 * np.pi, 6)
    places = np.stack([x, y], -1)
    z += 0.02 * np.cos(places @ wave + phase).sum(-1)
    angle = rng.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    chart = places @ turn * (0.75, 0.45) + (0, -0.7)
    points = np.stack([x, y, z], -1)
    return label_mesh(points.reshape(-1, 3), triangulate_grid(*x.shape), SKIN, chart.reshape(-1, 2))


def _make_close_up(head: LabelledMesh, rng: np.random.Generator) -> Shot:
    azimuth, elevation = _CLOSE_UPS[rng.integers(len(_CLOSE_UPS))]
    side = rng.choice([-1, 1])
    skin = head._replace(
        triangles=head.triangles[head.label == SKIN], label=head.label[head.label == SKIN]
    )
    point = find_vertex(skin, side * azimuth, elevation)
    angles = sample_angles(rng) * (0.5, 0.2, 1.0) - (0, 0.9 * side * azimuth, 0)
    return Shot(head, point, _frame(rng, angles, (3.2, 4.8), 0.05))
