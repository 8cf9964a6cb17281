"""Where a face is and how it is turned, by its landmarks."""

import math

import numpy as np
from numpy.typing import NDArray

from skinnet.images.box import Box
from skinnet.images.faces._face_mesh import MESH_POINTS
from skinnet.images.faces._mesh_outlines import BROW, CHIN
from skinnet.images.faces._turned_square import TurnedSquare

_SIDE, _RAISE = 3.37, 0.088
"""Side of the face's box in standard deviations of the mesh's points, and the height of its centre
above their mean in sides: medians over 402 portraits of the boxes of the cascade of local binary
patterns (Liao et al. 2007), with which the encoder's crops were made."""

_EYES = ((263, 362), (33, 133))
"""Corners of the person's left eye, and of the right one."""


def place_face(landmarks: NDArray[np.float32]) -> TurnedSquare:
    """The square from the brows to the chin, turned as the face is."""
    mesh = landmarks[:MESH_POINTS].astype(np.float64)
    tilt = _measure_tilt(mesh)
    side = _SIDE * float(np.sqrt(mesh.var(0).sum()))
    x, y = mesh.mean(0) + _RAISE * side * np.array([math.sin(tilt), -math.cos(tilt)])
    return TurnedSquare(float(x), float(y), side, tilt)


def to_box(square: TurnedSquare) -> Box:
    """The upright square of the same place and size, in whole pixels."""
    left, top, side = (
        round(value)
        for value in (square.x - square.side / 2, square.y - square.side / 2, square.side)
    )
    return Box(left, top, left + side, top + side)


def _measure_tilt(mesh: NDArray[np.float64]) -> float:
    """Angle in radians between the picture, and the eyes' line and the face's axis together."""
    left, right = (mesh[list(corners)].mean(0) for corners in _EYES)
    across, down = left - right, mesh[CHIN] - mesh[BROW]
    directions = [complex(*across), complex(down[1], -down[0])]
    total = sum(each / max(abs(each), 1e-9) for each in directions)
    return math.atan2(total.imag, total.real)
