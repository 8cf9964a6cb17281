"""The sclera, the white of the eyes, in a photograph of a face."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._mesh_outlines import LEFT_EYE, RIGHT_EYE
from skinnet.images.faces._near_white import select_near_white
from skinnet.images.faces._outlines import Patch, fill_outlines, measure_area, measure_depth
from skinnet.images.faces._skin_reference import Colours

_LEAST_WIDTH = 24.0
"""Least width of an eye, in pixels: in a smaller one all pixels of sclera are mixed with others."""

_LEAST_SIDE = 0.5
"""Least width of an eye in widths of the other one; a narrower one is turned away."""

_LEAST_OPENING = 0.12
"""Least area of an open eye, in squares of its width."""

_LID = 0.03
"""Width of the lids' edge, with lashes and their shadow, in widths of the eye."""

_IRIS = 1.1
"""Radius around the iris and its blurred edge, in radii of the iris."""

_CARUNCLE, _OUTER = 0.2, 0.95
"""Distances from the inner corner between which sclera is, in widths of the eye."""


class _Eye(NamedTuple):
    """An eye's contour, from the outer corner past the lower lid, and its iris, centre first."""

    contour: tuple[int, ...]
    iris: tuple[int, ...]


_EYES = (
    _Eye(RIGHT_EYE, (468, 469, 470, 471, 472)),
    _Eye(LEFT_EYE, (473, 474, 475, 476, 477)),
)

_INNER_CORNER = 8
"""Place of the inner corner in a contour."""


def locate_sclera(
    photo: NDArray[np.uint8], landmarks: NDArray[np.float32], skin: Colours
) -> list[Patch]:
    """Locate the sclera of the eyes.

    The iris, lashes, highlights, red veins and the caruncle in the inner corner are left out.

    Args:
        photo: uint8 sRGB [H, W, 3].
        landmarks: Points of the face mesh [478, 2], in pixels of the photograph.
        skin: The colour of the face's skin.

    Returns:
        Its pixels in each eye that is open, not turned away and at least 24 pixels wide.
    """
    points = landmarks.astype(np.float64)
    eyes = [(points[list(eye.contour)], points[list(eye.iris)]) for eye in _EYES]
    least_width = max(_LEAST_WIDTH, _LEAST_SIDE * max(_measure_width(eye) for eye, _ in eyes))
    found = []
    for contour, iris in eyes:
        width = _measure_width(contour)
        if width >= least_width and abs(measure_area(contour)) > _LEAST_OPENING * width**2:
            candidates = _list_candidates(contour, iris).clip(*photo.shape[:2])
            found.append(select_near_white(photo, candidates, skin))
    return found


def _measure_width(contour: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(contour[_INNER_CORNER] - contour[0]))


def _list_candidates(contour: NDArray[np.float64], iris: NDArray[np.float64]) -> Patch:
    """Pixels inside an eye that are not lids, iris or caruncle."""
    width = _measure_width(contour)
    patch = fill_outlines([contour])
    points = patch.centres
    radius = np.linalg.norm(iris[1:] - iris[0], axis=-1).mean()
    outer, inner = contour[0], contour[_INNER_CORNER]
    along = (points - inner) @ (outer - inner) / width**2
    white = (along > _CARUNCLE) & (along < _OUTER)
    white &= measure_depth(points, contour) > _LID * width
    white &= np.linalg.norm(points - iris[0], axis=-1) > _IRIS * radius
    return patch.choose(white)
