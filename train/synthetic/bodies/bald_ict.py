"""Bald heads of ICT-FaceKit, with expressions and a random gaze."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.expression import sample_any_expression, sample_expression
from train.synthetic.bodies.ict_model import EYEBALLS, FIRST_INNER_VERTEX, IctModel
from train.synthetic.bodies.labelled_mesh import LabelledMesh, clip, join, label_mesh
from train.synthetic.labels import EYE, MOUTH, SKIN, TEETH
from train.synthetic.variety import Variety

_IRIS_ANGLE = 0.395
"""Radians between the gaze and the edge of the iris: 5.9 mm on a ball of 15.3 mm."""

_NECK_HEIGHT = -1.5


def make_bald_ict(
    model: IctModel,
    rng: np.random.Generator,
    variety: Variety = "mild",
    expression: Mapping[str, float] | None = None,
) -> tuple[LabelledMesh, Neck]:
    """Make a bald head of a random person with an expression.

    Args:
        model: ICT-FaceKit's.
        rng: Random numbers.
        variety: Which kind of expressions.
        expression: Weights of shapes by their names, others are 0; None: they are sampled.

    Returns:
        The head, and where its neck ends.
    """
    person = 0.9 * rng.normal(0, 1, len(model.identities)).clip(-2.5, 2.5)
    gaze = rng.normal(0, (0.10, 0.06)).clip(-0.2, 0.2)
    sample = sample_expression if variety == "mild" else sample_any_expression
    weights = sample(model.names, gaze, rng)
    if expression is not None:
        weights = np.array([expression.get(name, 0.0) for name in model.names])
    shape = model.mean + np.tensordot(person.astype(np.float32), model.identities, 1)
    active = np.flatnonzero(weights)
    moved = np.tensordot(weights[active].astype(np.float32), model.expressions[active], 1)
    shape, chart = shape + moved, model.chart.copy()
    for first, end in EYEBALLS:
        ball = model.mean[first:end]
        chart[first:end] = _chart_eye(ball)
        shape[first:end] = _rotate_eye(shape[first:end], gaze)
    inside = np.isin(np.arange(len(shape)), model.triangles[np.isin(model.label, (TEETH, MOUTH))])
    inside &= np.arange(len(shape)) >= FIRST_INNER_VERTEX
    chart[inside] = shape[inside, :2]
    parts = [
        label_mesh(shape, model.triangles[model.label == label], label, chart)
        for label in (SKIN, MOUTH, TEETH, EYE)
    ]
    parts[0] = clip(parts[0], parts[0].vertices[:, 1] - _NECK_HEIGHT)
    return join(parts), _find_neck(parts[0])


def _chart_eye(ball: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
    """Angles from an eye's axis, in iris radii."""
    x, y, z = (ball - _find_centre(ball)).T
    across = np.hypot(x, y)
    scale = np.arctan2(across, z) / _IRIS_ANGLE / across.clip(1e-9)
    return np.asarray(np.stack([x, y], 1) * scale[:, None])


def _find_centre(ball: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "3"]:
    """Middle of an eyeball without its cornea, which bulges forward."""
    low, high = ball.min(0), ball.max(0)
    middle = np.asarray((low + high) / 2)
    middle[2] = low[2] + (high - low)[:2].mean() / 2
    return middle


def _rotate_eye(
    ball: Float[np.ndarray, "points 3"], gaze: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "points 3"]:
    """Rotate an eyeball by `gaze` radians to the face's left and up."""
    (a, b), (p, q) = np.cos(gaze), np.sin(gaze)
    left = np.array([[a, 0, p], [0, 1, 0], [-p, 0, a]])
    up = np.array([[1, 0, 0], [0, b, q], [0, -q, b]])
    middle = _find_centre(ball)
    return np.asarray((ball - middle) @ (left @ up).T + middle)


def _find_neck(skin: LabelledMesh) -> Neck:
    ring = skin.vertices[np.abs(skin.vertices[:, 1] + 1.25) < 0.1]
    low, high = ring.min(0), ring.max(0)
    x, _, z = (low + high) / 2
    return Neck(float(x), float(z), float((high - low)[0] / 2), float((high - low)[2] / 2))
