"""Squares of a photograph that may be turned: cut, and the way back for points."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

_ENOUGH_DETAIL = 1.4
"""Pixels of the photograph in one of the cut square, across, to about which the photograph is
shrunk first; bilinear interpolation of more would skip some."""

_GREY = (128, 128, 128)
"""Colour of what is outside the photograph."""


class TurnedSquare(NamedTuple):
    """A square of a photograph.

    Attributes:
        x: Column of its centre, in pixels.
        y: Row of its centre.
        side: Its side, in pixels.
        tilt: Angle by which it is turned clockwise, in radians.
    """

    x: float
    y: float
    side: float
    tilt: float = 0.0

    def cut(self, photo: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
        """Cut the square from a photograph [H, W, 3], upright: uint8 [size, size, 3]."""
        shrink = max(1, round(self.side / size / _ENOUGH_DETAIL))
        left, top, right, bottom = self._bounds(photo.shape)
        if right <= left or bottom <= top:
            return np.full((size, size, 3), _GREY, np.uint8)
        part = Image.fromarray(np.ascontiguousarray(photo[top:bottom, left:right]))
        matrix = self.matrix(size)
        matrix[:, 2] -= left, top
        cut = part.reduce(shrink).transform(
            (size, size),
            Image.Transform.AFFINE,
            tuple((matrix / shrink).ravel()),
            Image.Resampling.BILINEAR,
            fillcolor=_GREY,
        )
        return np.array(cut)

    def place(self, points: NDArray[np.floating], size: int) -> NDArray[np.float64]:
        """Place points [..., 2] of the cut square of `size` pixels in the photograph."""
        matrix = self.matrix(size)
        return np.asarray(points @ matrix[:, :2].T + matrix[:, 2])

    @property
    def corners(self) -> NDArray[np.float64]:
        """Columns and rows [4, 2] of its corners in the photograph, one after the other."""
        return self.place(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), 1)

    def matrix(self, size: int) -> NDArray[np.float64]:
        """The affine matrix [2, 3] from the cut square of `size` pixels to the photograph."""
        scale = self.side / size
        cos, sin = scale * math.cos(self.tilt), scale * math.sin(self.tilt)
        turn = np.array([[cos, -sin], [sin, cos]])
        return np.column_stack([turn, (self.x, self.y) - turn @ (size / 2, size / 2)])

    def _bounds(self, shape: tuple[int, ...]) -> tuple[int, int, int, int]:
        """Left, top, right and bottom of the part of a photograph that the square covers."""
        half = self.side / 2 * (abs(math.cos(self.tilt)) + abs(math.sin(self.tilt)))
        left, top = (max(0, math.floor(centre - half)) for centre in (self.x, self.y))
        right = min(shape[1], math.ceil(self.x + half))
        return left, top, right, min(shape[0], math.ceil(self.y + half))


def measure_overlap(a: TurnedSquare, b: TurnedSquare) -> float:
    """Intersection over union of two squares, as if they were upright."""
    half = (a.side + b.side) / 2
    shared = [
        np.clip(min(half - abs(p - q), a.side, b.side), 0, None)
        for p, q in ((a.x, b.x), (a.y, b.y))
    ]
    common = float(shared[0] * shared[1])
    return common / (a.side**2 + b.side**2 - common)
