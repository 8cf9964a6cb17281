"""Shells around a head: cloth and hair that are stretched over it and stand off the skin."""

from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from train.synthetic.bodies.labelled_mesh import LabelledMesh, label_mesh, triangulate_grid

_LOWEST = -1.22
"""Lowest elevation on the chart that belongs to the head alone, not to the neck."""

_NEIGHBOURS = 6

Grid = Float[np.ndarray, "rows columns"]
Points = Float[np.ndarray, "rows columns 3"]


class HeadSurface:
    """Finds points of a head's skin by their places on its chart.

    Args:
        skin: The head's skin.
    """

    def __init__(self, skin: LabelledMesh) -> None:
        self.skin = skin

    @cached_property
    def _tree(self) -> tuple[cKDTree, Float[np.ndarray, "points 3"]]:
        head = self.skin.chart[:, 1] > _LOWEST
        return cKDTree(_embed(*self.skin.chart[head].T)), self.skin.vertices[head]

    def place(self, azimuth: Grid, elevation: Grid) -> Points:
        """Interpolate the skin at places on its chart, in radians."""
        tree, vertices = self._tree
        azimuth, elevation = np.broadcast_arrays(azimuth, elevation)
        distance, index = tree.query(_embed(azimuth, elevation), _NEIGHBOURS)
        weight = np.asarray(1 / (distance + 1e-3) ** 2)
        index = np.asarray(index)
        points = (vertices[index] * weight[..., None]).sum(-2) / weight.sum(-1)[..., None]
        # A mean of neighbours lies under the tip of a nose.
        farthest = np.linalg.norm(vertices[index[..., :3]], axis=-1).max(-1)
        return np.asarray(points * (farthest / np.linalg.norm(points, axis=-1))[..., None])


def _embed(
    azimuth: Float[np.ndarray, "*points"], elevation: Float[np.ndarray, "*points"]
) -> Float[np.ndarray, "*points 3"]:
    """Unit vectors of angles, which have neither seam nor pole."""
    across = np.cos(elevation)
    return np.stack([across * np.sin(azimuth), np.sin(elevation), across * np.cos(azimuth)], -1)


def stretch(
    points: Points,
    off: Grid | float,
    steps: int,
    held: Bool[np.ndarray, "rows columns"] | None = None,
) -> Points:
    """Stretch cloth over an obstacle: it spans hollows and lies on what stands out.

    Args:
        points: The obstacle, star-shaped around the origin.
        off: Distance between cloth and obstacle.
        steps: Steps of smoothing; hollows as wide as its square root are spanned.
        held: Where the cloth lies on the obstacle; None: along the grid's four borders.

    Returns:
        Points on the same rays from the origin, none of them nearer than the obstacle.
    """
    length = np.linalg.norm(points, axis=-1)
    obstacle = length + off
    if held is None:
        held = np.ones(length.shape, bool)
        held[1:-1, 1:-1] = False
    radius = obstacle.copy()
    for _ in range(steps):
        wide = np.pad(radius, 1, "edge")
        mean = (wide[:-2, 1:-1] + wide[2:, 1:-1] + wide[1:-1, :-2] + wide[1:-1, 2:]) / 4
        radius = np.where(held, obstacle, np.maximum(obstacle, mean))
    return np.asarray(points * (radius / length)[..., None])


def make_room_for_ears(azimuth: Grid, elevation: Grid) -> Grid:
    """How much farther from the chart's surface cloth lies where ears stand out under it."""
    across, up = (np.abs(azimuth) - 1.52) / 0.24, (elevation + 0.1) / 0.3
    return np.asarray(0.09 * np.exp(-(across**2) - up**2))


def move_out(points: Points, distance: Grid) -> Points:
    """Move points away from the origin."""
    length = np.linalg.norm(points, axis=-1)
    return np.asarray(points * (1 + distance / length)[..., None])


def sample_waves(
    rng: np.random.Generator, first: Grid, second: Grid, rate: tuple[float, float]
) -> Grid:
    """Sample a smooth field of variance about one over two coordinates.

    Args:
        rng: Random numbers.
        first: A coordinate.
        second: Another.
        rate: Typical radians of phase over one unit of each.

    Returns:
        The field.
    """
    wave, phase = rng.normal(0, 1, (2, 7)), rng.uniform(0, 2 * np.pi, 7)
    waves = [
        np.cos(rate[0] * a * first + rate[1] * b * second + shift)
        for a, b, shift in zip(*wave, phase, strict=True)
    ]
    return np.asarray(np.sum(waves, 0) * np.sqrt(2 / len(waves)))


def make_sheet(
    points: Points, label: int, first: Grid, second: Grid, outside_out: bool = True
) -> LabelledMesh:
    """Make a sheet of cloth from a grid of points and their places on its chart."""
    triangles = triangulate_grid(*points.shape[:2])
    chart = np.stack(np.broadcast_arrays(first, second), -1)
    if not outside_out:
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    return label_mesh(points.reshape(-1, 3), triangles, label, chart.reshape(-1, 2))
