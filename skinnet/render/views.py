"""Where a picture is taken from."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError


class Rays(NamedTuple):
    """One ray a sample, row by row from the top left; `directions` have length one."""

    origins: Float[np.ndarray, "rays 3"]
    directions: Float[np.ndarray, "rays 3"]


@runtime_checkable
class View(Protocol):
    """A camera: `size` (height, width) in pixels, and a ray through every sample of them."""

    @property
    def size(self) -> tuple[int, int]: ...

    def rays(self, samples: int) -> Rays:
        """`samples` x `samples` rays evenly over each pixel."""
        ...

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Column and row of points, (0, 0) the picture's upper left corner."""
        ...


@dataclass(frozen=True)
class PerspectiveView:
    """A pinhole at `eye` with `focal` length in pixels and its axis through the picture's middle.

    The rows of `rotation` are the camera's right, up and backward axes in the world, in whose unit
    `eye` is.
    """

    size: tuple[int, int]
    eye: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    focal: float

    def rays(self, samples: int) -> Rays:
        """`samples` x `samples` rays evenly over each pixel."""
        x, y = _grid(self.size, samples)
        local = np.stack([x, y, np.full_like(x, -self.focal)], 1)
        local /= np.linalg.norm(local, axis=1, keepdims=True)
        return Rays(np.broadcast_to(self.eye, local.shape), local @ self.rotation)

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Column and row of points in front of the camera."""
        local = (points - self.eye) @ self.rotation.T
        return _pixels(self.size, local[:, :2] * (self.focal / -local[:, 2:]))


@dataclass(frozen=True)
class OrthographicView:
    """Parallel rays: `eye` in the middle of the picture's plane, `scale` in pixels a unit.

    The rows of `rotation` are the camera's right, up and backward axes. Only what lies in front of
    the plane is seen.
    """

    size: tuple[int, int]
    eye: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    scale: float

    def rays(self, samples: int) -> Rays:
        """`samples` x `samples` rays evenly over each pixel."""
        x, y = _grid(self.size, samples)
        local = np.stack([x, y, np.zeros_like(x)], 1) / self.scale
        origins = local @ self.rotation + self.eye
        return Rays(origins, np.broadcast_to(-self.rotation[2], origins.shape))

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Column and row of points."""
        local = (points - self.eye) @ self.rotation.T
        return _pixels(self.size, local[:, :2] * self.scale)


def frame_face(
    vertices: Float[np.ndarray, "vertices 3"],
    size: tuple[int, int],
    turn: float = 0.0,
    tilt: float = 0.0,
    field: float = 20.0,
    fill: float = 0.92,
) -> PerspectiveView:
    """A camera before a face, as near as leaves all of it within `fill` of the picture.

    From straight ahead (+z, y up) it goes `turn` degrees around to the face's left and then `tilt`
    degrees up; `field` is the angle of view over the picture's height, in degrees.
    """
    height, width = size
    if min(size) < 1:
        raise InputError(f"A picture has at least one pixel a side; got {height} x {width}.")
    rotation = view_axes(turn, tilt)
    focal = height / 2 / np.tan(np.deg2rad(field) / 2)
    low, high = (vertices @ rotation.T).min(0), (vertices @ rotation.T).max(0)
    middle = (low + high) / 2
    local = vertices @ rotation.T - middle
    half = np.array([width, height]) / 2 * fill
    distance = (local[:, 2:] + np.abs(local[:, :2]) * focal / half).max()
    eye = (middle + [0, 0, distance]) @ rotation
    return PerspectiveView(size, eye, rotation, float(focal))


def view_axes(turn: float, tilt: float = 0.0) -> Float[np.ndarray, "3 3"]:
    """Right, up and backward axes of a camera that looks at the origin from `turn` degrees to the
    left of a face and `tilt` degrees above it."""
    a, b = np.deg2rad(turn), np.deg2rad(tilt)
    back = np.array([np.sin(a) * np.cos(b), np.sin(b), np.cos(a) * np.cos(b)])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    return np.stack([right, np.cross(back, right), back])


def _grid(
    size: tuple[int, int], samples: int
) -> tuple[Float[np.ndarray, "rays"], Float[np.ndarray, "rays"]]:
    """Places of the samples in pixels from the middle, x to the right and y up."""
    height, width = size
    x = (np.arange(width * samples) + 0.5) / samples - width / 2
    y = height / 2 - (np.arange(height * samples) + 0.5) / samples
    return np.tile(x, len(y)), np.repeat(y, len(x))


def _pixels(
    size: tuple[int, int], local: Float[np.ndarray, "points 2"]
) -> Float[np.ndarray, "points 2"]:
    return local * [1, -1] + np.array([size[1], size[0]]) / 2
