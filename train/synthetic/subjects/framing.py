"""How pictures are framed: what they show, from which side and how large."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.render import OrthographicView, PerspectiveView

Kind = Literal["face", "group", "skin"]

KINDS: dict[Kind, float] = {"face": 0.65, "group": 0.15, "skin": 0.20}
"""Shares of pictures of one person, of two to four people, and of skin without a face."""

MAX_ANGLES = np.radians((30.0, 60.0, 45.0))
"""Largest pitch, yaw and roll of a head."""

HEIGHTS = (0.12, 0.4, 0.9, 1.8)
"""Heights of heads over that of the picture: limits of small, usual and frame-filling heads."""

_HEIGHT_SHARES = (0.2, 0.5, 0.3)

_PORTRAIT_ANGLE_SD, _PORTRAIT_MAX_ANGLE = (0.12, 0.35, 0.10), 0.6
"""Standard deviations of pitch, yaw and roll, and their largest magnitude, in radians."""

_FAR = 20.0


class Framing(NamedTuple):
    """A camera before a point.

    `angles` are pitch, yaw and roll in radians. `zoom` is the length of two half heads over the
    side of the picture. `centre` is where the point lies in the picture, in [-1, 1] to the right
    and up. `distance` of the camera is in half heads; orthographic cameras have none.
    """

    angles: Float[np.ndarray, "3"]
    zoom: float
    centre: Float[np.ndarray, "2"]
    distance: float
    orthographic: bool


def sample_kind(rng: np.random.Generator) -> Kind:
    """Sample what a picture shows, with the shares of `KINDS`."""
    kinds = list(KINDS)
    return kinds[rng.choice(len(kinds), p=list(KINDS.values()))]


def sample_portrait_framing(rng: np.random.Generator) -> Framing:
    """Sample a camera that sees a head of the variety `mild`, as in a portrait.

    Args:
        rng: Random numbers.

    Returns:
        The framing of a head on half to three quarters of the picture's height.
    """
    angles = rng.normal(0, _PORTRAIT_ANGLE_SD).clip(-_PORTRAIT_MAX_ANGLE, _PORTRAIT_MAX_ANGLE)
    zoom = rng.uniform(0.48, 0.75)
    centre = rng.normal(0, (0.06, 0.08)).clip(-0.2, 0.2) + (0.0, 0.05)
    return Framing(angles, zoom, centre, rng.uniform(7.0, _FAR), bool(rng.random() < 0.25))


def sample_framing(rng: np.random.Generator) -> Framing:
    """Sample the framing of one head of the variety `any`.

    Yaw is uniform to 60 degrees in six of ten pictures and of 17 degrees standard deviation in the
    others. Pitch has 11 degrees and ends at 30. Roll is uniform to 45 degrees in half of the
    pictures and of 7 degrees in the others. Heads are .12 to .4 of the picture's height (a share of
    .2), .4 to .9 (.5), or .9 to 1.8 (.3). In half of the pictures the head lies anywhere, at times
    cut by the edge.

    Args:
        rng: Random numbers.

    Returns:
        The framing.
    """
    part = rng.choice(3, p=_HEIGHT_SHARES)
    zoom = float(np.exp(rng.uniform(*np.log(HEIGHTS[part : part + 2]))))
    anywhere = rng.uniform(-1, 1, 2) * max(1 - 0.3 * zoom, 0.3)
    centre = anywhere if rng.random() < 0.5 else rng.normal((0, 0.05), 0.1).clip(-0.3, 0.3)
    return Framing(
        sample_angles(rng), zoom, centre, rng.uniform(5.0, _FAR), bool(rng.random() < 0.2)
    )


def sample_angles(rng: np.random.Generator) -> Float[np.ndarray, "3"]:
    """Sample pitch, yaw and roll of a head in radians, as `sample_framing` describes them."""
    wide = rng.uniform(-1, 1, 3) * MAX_ANGLES
    narrow = rng.normal(0, (0.19, 0.3, 0.12)).clip(-MAX_ANGLES, MAX_ANGLES)
    return np.asarray(np.where(rng.random(3) < (0.0, 0.6, 0.5), wide, narrow))


def make_view(
    framing: Framing, point: Float[np.ndarray, "3"], size: int
) -> OrthographicView | PerspectiveView:
    """Make the camera of a framing.

    Args:
        framing: The framing.
        point: What it is centred on.
        size: Side of the picture in pixels.

    Returns:
        The camera.
    """
    axes = rotate(framing.angles)
    distance = _FAR if framing.orthographic else framing.distance
    eye = point + np.array([*(-framing.centre / framing.zoom), distance]) @ axes
    scale = framing.zoom * size / 2
    if framing.orthographic:
        return OrthographicView((size, size), eye, axes, scale)
    return PerspectiveView((size, size), eye, axes, scale * distance)


def rotate(angles: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Make the matrix from the head's axes to the camera's: pitch, then yaw, then roll.

    Args:
        angles: Pitch, yaw and roll in radians.

    Returns:
        The matrix, whose rows are the camera's axes.

    Example:
        >>> rotate(np.array([0, np.pi / 2, 0])).round() @ [0, 0, 1]
        array([1., 0., 0.])
    """
    (a, b, c), (p, q, r) = np.cos(angles), np.sin(angles)
    pitch = np.array([[1, 0, 0], [0, a, -p], [0, p, a]])
    yaw = np.array([[b, 0, q], [0, 1, 0], [-q, 0, b]])
    roll = np.array([[c, -r, 0], [r, c, 0], [0, 0, 1]])
    return np.asarray(roll @ yaw @ pitch)
