"""Views: where a picture is taken from, and the rays through its pixels."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.render._view_axes import compute_view_axes

_Rays = tuple[Float[np.ndarray, "rays 3"], Float[np.ndarray, "rays 3"]]
"""Origins and unit directions of rays, row by row from the top left of the picture."""


@runtime_checkable
class View(Protocol):
    """A viewpoint with a picture of `size` (height, width) in pixels."""

    @property
    def size(self) -> tuple[int, int]:
        """Height and width of the picture in pixels."""
        ...

    def rays(self, samples: int) -> _Rays:
        """Make `samples` x `samples` rays, evenly spread over each pixel.

        Args:
            samples: Rays along either side of a pixel.

        Returns:
            Origins and unit directions, row by row from the top left of the picture.
        """
        ...

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Project points to pixels.

        Args:
            points: Positions in the world.

        Returns:
            Column and row in pixels; (0, 0) is the upper left corner of the picture.
        """
        ...


@dataclass(frozen=True)
class PerspectiveView:
    """A pinhole view whose axis goes through the middle of the picture.

    Args:
        size: Height and width of the picture in pixels.
        eye: Position of the pinhole in the world.
        rotation: The view's right, up and backward axes in the world, one a row.
        focal: Focal length in pixels.

    Example:
        >>> import numpy as np
        >>> from skinnet.render import PerspectiveView
        >>> view = PerspectiveView((20, 30), np.array([0.0, 0.0, 5.0]), np.eye(3), focal=10.0)
        >>> view.project(np.array([[1.0, 1.0, 0.0]]))
        array([[17.,  8.]])
    """

    size: tuple[int, int]
    eye: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    focal: float

    def rays(self, samples: int) -> _Rays:
        """Make `samples` x `samples` rays, evenly spread over each pixel.

        Args:
            samples: Rays along either side of a pixel.

        Returns:
            Origins and unit directions, row by row from the top left of the picture.
        """
        x, y = _grid(self.size, samples)
        local = np.stack([x, y, np.full_like(x, -self.focal)], 1)
        local /= np.linalg.norm(local, axis=1, keepdims=True)
        return np.broadcast_to(self.eye, local.shape), local @ self.rotation

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Project points in front of the view to pixels.

        Args:
            points: Positions in the world.

        Returns:
            Column and row in pixels; (0, 0) is the upper left corner of the picture.
        """
        local = (points - self.eye) @ self.rotation.T
        return _pixels(self.size, local[:, :2] * (self.focal / -local[:, 2:]))


@dataclass(frozen=True)
class OrthographicView:
    """A view along parallel rays. Surfaces behind the plane of the picture are not visible.

    Args:
        size: Height and width of the picture in pixels.
        eye: Middle of the picture's plane in the world.
        rotation: The view's right, up and backward axes in the world, one a row.
        scale: Pixels per unit of the world.

    Example:
        >>> import numpy as np
        >>> from skinnet.render import OrthographicView
        >>> view = OrthographicView((20, 30), np.array([0.0, 0.0, 5.0]), np.eye(3), scale=2.0)
        >>> view.project(np.array([[1.0, 1.0, 0.0]]))
        array([[17.,  8.]])
    """

    size: tuple[int, int]
    eye: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    scale: float

    def rays(self, samples: int) -> _Rays:
        """Make `samples` x `samples` rays, evenly spread over each pixel.

        Args:
            samples: Rays along either side of a pixel.

        Returns:
            Origins and unit directions, row by row from the top left of the picture.
        """
        x, y = _grid(self.size, samples)
        local = np.stack([x, y, np.zeros_like(x)], 1) / self.scale
        origins = local @ self.rotation + self.eye
        return origins, np.broadcast_to(-self.rotation[2], origins.shape)

    def project(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Project points to pixels.

        Args:
            points: Positions in the world.

        Returns:
            Column and row in pixels; (0, 0) is the upper left corner of the picture.
        """
        local = (points - self.eye) @ self.rotation.T
        return _pixels(self.size, local[:, :2] * self.scale)


def frame_face(
    vertices: Float[np.ndarray, "vertices 3"],
    size: tuple[int, int],
    yaw: float = 0.0,
    pitch: float = 0.0,
    field_of_view: float = 20.0,
    fill: float = 0.92,
) -> PerspectiveView:
    """Place a view in front of a face, so near that the face fills a share `fill` of the picture.

    Args:
        vertices: Positions, x to the face's left, y up and z forward.
        size: Height and width of the picture in pixels.
        yaw: Angle in degrees by which the eye moves around to the face's left; at 0 it is on +z.
        pitch: Angle in degrees by which the eye moves up.
        field_of_view: Vertical field of view in degrees.
        fill: Share of the picture's width or height that the face fills.

    Returns:
        The view.

    Raises:
        InputError: For a picture without pixels.

    Example:
        >>> import numpy as np
        >>> from skinnet.render import frame_face
        >>> view = frame_face(np.array([[-70.0, -100, 0], [70, 100, 0]]), (200, 200), fill=0.9)
        >>> view.project(np.array([[0.0, 0, 0], [0, 100, 0]])).round(6)
        array([[100., 100.],
               [100.,  10.]])
    """
    height, width = size
    if min(size) < 1:
        raise InputError(f"A picture has at least one pixel a side; got {height} x {width}.")
    rotation = compute_view_axes(yaw, pitch)
    focal = height / 2 / np.tan(np.deg2rad(field_of_view) / 2)
    low, high = (vertices @ rotation.T).min(0), (vertices @ rotation.T).max(0)
    middle = (low + high) / 2
    local = vertices @ rotation.T - middle
    half = np.array([width, height]) / 2 * fill
    distance = (local[:, 2:] + np.abs(local[:, :2]) * focal / half).max()
    eye = (middle + [0, 0, distance]) @ rotation
    return PerspectiveView(size, eye, rotation, float(focal))


def _grid(
    size: tuple[int, int], samples: int
) -> tuple[Float[np.ndarray, "rays"], Float[np.ndarray, "rays"]]:
    """Compute the positions of samples in pixels from the middle, x to the right and y up."""
    height, width = size
    x = (np.arange(width * samples) + 0.5) / samples - width / 2
    y = height / 2 - (np.arange(height * samples) + 0.5) / samples
    return np.tile(x, len(y)), np.repeat(y, len(x))


def _pixels(
    size: tuple[int, int], local: Float[np.ndarray, "points 2"]
) -> Float[np.ndarray, "points 2"]:
    """Convert positions in pixels from the middle to columns and rows."""
    return local * [1, -1] + np.array([size[1], size[0]]) / 2
