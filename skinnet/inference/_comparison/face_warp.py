"""The warp from one photograph of a face to another one, by the points of the face mesh."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.interpolate import LinearNDInterpolator

from skinnet.errors import InputError
from skinnet.images.faces._face_mesh import MESH_POINTS

_FAR = 10.0
"""Distance of the corners around the mesh, in its own sides, where the warp is the affine one."""

_MOST_BENT = 0.05
"""Largest root mean square of what an affine map leaves of the landmarks, in lengths of the face.

A turn of the head by 20 degrees leaves about this: the mesh then only guesses where a part of one
cheek is, and the light falls on the other parts in another way."""

Points = NDArray[np.floating]


class FaceWarp(NamedTuple):
    """A warp between two photographs.

    Attributes:
        mesh: Piecewise affine over the triangles between landmarks, affine outside.
        bend: Root mean square of what an affine map leaves of the landmarks, in lengths of the
            face.
    """

    mesh: LinearNDInterpolator
    bend: float

    @classmethod
    def between(cls, before: Points, after: Points) -> "FaceWarp":
        """Make the warp from the landmarks [478, 2] of one photograph to those of another one."""
        first, second = (points[:MESH_POINTS].astype(np.float64) for points in (before, after))
        affine, *_ = np.linalg.lstsq(_homogeneous(first), second, rcond=None)
        left = second - _homogeneous(first) @ affine
        bend = float(np.sqrt((left**2).sum(-1).mean())) / measure_face(second)
        middle, reach = first.mean(0), _FAR * np.ptp(first, axis=0).max()
        corners = middle + reach * np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)])
        sources = np.concatenate([first, corners])
        targets = np.concatenate([second, _homogeneous(corners) @ affine])
        return cls(LinearNDInterpolator(sources, targets), bend)

    def refuse_other_pose(self, names: tuple[str, str]) -> None:
        """Refuse two poses that differ too much.

        Raises:
            InputError: They do.
        """
        if self.bend > _MOST_BENT:
            raise InputError(
                f"The poses of the face in {names[0]} and {names[1]} differ too much to compare "
                f"them: the mesh of one fits the other within {self.bend:.1%} of the face's "
                f"length, and {_MOST_BENT:.0%} is the most. Photograph the face from the same side."
            )

    def map(self, points: Points) -> NDArray[np.float64]:
        """Map columns and rows [..., 2] of the first photograph to those of the second one."""
        mapped: NDArray[np.float64] = self.mesh(points)
        return mapped


def sample_at(channels: NDArray[np.float32], points: Points) -> NDArray[np.float32]:
    """Sample an image [H, W, channels] bilinearly at columns and rows [..., 2]; NaN outside."""
    at = np.moveaxis(points[..., ::-1], -1, 0) - 0.5
    sampled = [
        ndimage.map_coordinates(one, at, order=1, mode="constant", cval=np.nan)
        for one in np.moveaxis(channels, -1, 0)
    ]
    return np.stack(sampled, -1).astype(np.float32)


def measure_face(landmarks: Points) -> float:
    """The length of a face in pixels: the square root of the area of its mesh's box."""
    return math.sqrt(float(np.prod(np.ptp(landmarks[:MESH_POINTS], axis=0))))


def _homogeneous(points: Points) -> NDArray[np.float64]:
    return np.concatenate([points, np.ones((len(points), 1))], -1)
