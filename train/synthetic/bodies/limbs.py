"""Tubes with round ends, of which arms, fingers and legs are made."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.labelled_mesh import LabelledMesh, label_mesh, triangulate_grid

_AROUND, _CAP = 28, 7

Points = Float[np.ndarray, "points 3"]
Vector = Float[np.ndarray, "3"]


class Tube(NamedTuple):
    """A line with an elliptic section at each of its points; lengths are in half heads.

    `width` is the half axis to the side and `depth` that to the back, which is the direction of
    `back` as far as it is across the line. `along` is the elevation on the chart.
    """

    line: Points
    back: Points
    width: Float[np.ndarray, "points"]
    depth: Float[np.ndarray, "points"]
    along: Float[np.ndarray, "points"]


def make_tube(tube: Tube, label: int) -> LabelledMesh:
    """Make a tube that is closed by a round cap at both ends.

    Args:
        tube: Its line and sections.
        label: Label of all its triangles.

    Returns:
        The mesh. Azimuth on its chart is 0 at the back and reaches `CHART_EXTENT` at the front.
    """
    line, back, width, depth, along = _add_caps(tube)
    tangent = _normalise(np.gradient(line, axis=0))
    side = _normalise(np.cross(back, tangent))
    up = np.cross(tangent, side)
    angle = np.linspace(-np.pi, np.pi, _AROUND + 1)
    across = np.sin(angle)[:, None] * (width[:, None] * side)[:, None]
    outwards = np.cos(angle)[:, None] * (depth[:, None] * up)[:, None]
    points = line[:, None] + across + outwards
    chart = np.stack(np.broadcast_arrays(angle * 2 / np.pi, along[:, None]), -1)
    triangles = triangulate_grid(len(line), _AROUND + 1)
    return label_mesh(points.reshape(-1, 3), triangles, label, chart.reshape(-1, 2))


def _add_caps(tube: Tube) -> Tube:
    """Continue a line by half a sphere's profile at both ends."""
    share = np.cos(np.linspace(0, np.pi / 2, _CAP + 1)[1:]).clip(0.02)
    reach = np.sqrt(1 - share**2)
    tangent = _normalise(np.gradient(tube.line, axis=0))
    parts = []
    for end, sign, order in ((0, -1, slice(None, None, -1)), (-1, 1, slice(None))):
        radius = min(tube.width[end], tube.depth[end])
        parts.append(
            Tube(
                (tube.line[end] + sign * radius * reach[:, None] * tangent[end])[order],
                np.repeat(tube.back[end][None], _CAP, 0),
                (tube.width[end] * share)[order],
                (tube.depth[end] * share)[order],
                np.full(_CAP, tube.along[end]),
            )
        )
    return Tube(*(np.concatenate(three) for three in zip(parts[0], tube, parts[1], strict=True)))


def bend_line(corners: Points, count: int, softness: float) -> Points:
    """Sample a line through corners evenly, and round the corners.

    Args:
        corners: Its corners.
        count: Number of points.
        softness: Share of the line's length over which a corner is rounded.

    Returns:
        Points on the line, the ends of which stay where they are.
    """
    length = np.r_[0, np.linalg.norm(np.diff(corners, axis=0), axis=1).cumsum()]
    at = np.linspace(0, length[-1], count)
    offsets = np.linspace(-1, 1, 9) * softness * length[-1] / 2
    # The window closes at both ends.
    room = np.minimum(at, length[-1] - at)[:, None]
    places = at[:, None] + np.clip(offsets, -room, room)
    return np.stack([np.interp(places, length, one).mean(1) for one in corners.T], 1)


def find_elbow(
    shoulder: Vector, wrist: Vector, lengths: tuple[float, float], pole: Vector
) -> Vector:
    """Find the elbow of an arm, between a shoulder and a wrist.

    Args:
        shoulder: One end.
        wrist: The other end; an arm that is too short is stretched.
        lengths: Lengths of upper arm and forearm.
        pole: Direction in which the elbow points.

    Returns:
        The elbow.

    Example:
        >>> find_elbow(np.zeros(3), np.array([0, 6.0, 0]), (5, 5), np.array([1.0, 0, 0]))
        array([4., 3., 0.])
    """
    way = wrist - shoulder
    distance = float(np.linalg.norm(way))
    upper, lower = np.array(lengths) * max(1.0, 1.01 * distance / sum(lengths))
    ahead = way / distance
    along = (distance**2 + upper**2 - lower**2) / (2 * distance)
    across = pole - (pole @ ahead) * ahead
    height = np.sqrt(max(upper**2 - along**2, 0.0))
    return np.asarray(shoulder + along * ahead + height * across / np.linalg.norm(across))


def _normalise(vectors: Points) -> Points:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True).clip(1e-9))
