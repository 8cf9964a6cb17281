"""Landmarks and the white of the eyes, beside the templates of the London set.

A template has 189 points of its own. A few mark the same place as a point of the mesh; the others
lie on an outline that the mesh has too, and are compared with that line.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from skimage.measure import points_in_poly

from benchmarks.portrait_faces import LEFT_EYE, RIGHT_EYE

Points = NDArray[np.floating]
Lines = Mapping[tuple[int, ...], tuple[int, ...]]

LINES: Mapping[str, Lines] = {
    "eyes": {
        (0,): (468,),
        (1,): (473,),
        (18,): (33,),
        (22,): (133,),
        (23,): (362,),
        (27,): (263,),
        (19, 20, 21): (33, 246, 161, 160, 159, 158, 157, 173, 133),
        (28, 29, 30): (33, 7, 163, 144, 145, 153, 154, 155, 133),
        (24, 25, 26): (362, 398, 384, 385, 386, 387, 388, 466, 263),
        (31, 32, 33): (362, 382, 381, 380, 374, 373, 390, 249, 263),
    },
    "nose": {
        (63, 64, 55, 69, 68): (102, 48, 64, 98, 97, 2, 326, 327, 294, 278, 331),
    },
    "mouth": {
        (87,): (61,),
        (93,): (291,),
        (90,): (0,),
        (88, 89, 91, 92): (61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291),
        (104, 105, 106, 107, 108): (61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291),
        (95, 96, 97): (78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308),
        (100, 101, 102): (78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308),
    },
}
"""Points of a template, and the point or line of the mesh on which they lie, by feature."""

EYES = ((18, 19, 20, 21, 22, 30, 29, 28), (23, 24, 25, 26, 27, 33, 32, 31))
"""Outlines of a template's eyes."""


def measure_distances(template: Points, landmarks: Points) -> dict[str, list[float]]:
    """Measure distances from a template's points to the mesh, relative to that between the eyes.

    Args:
        template: Columns and rows [189, 2] in indices of pixels.
        landmarks: Columns and rows [478, 2] from the picture's corner.
    """
    placed = template + 0.5
    eyes = float(np.linalg.norm(placed[RIGHT_EYE] - placed[LEFT_EYE]))
    return {
        feature: [
            measure_distance(placed[point], landmarks[list(line)]) / eyes
            for points, line in lines.items()
            for point in points
        ]
        for feature, lines in LINES.items()
    }


def measure_distance(point: Points, line: Points) -> float:
    """Measure the distance of a point [2] from a line through points [count, 2]."""
    start, ends = line[:-1], np.diff(line, axis=0)
    if not len(ends):
        return float(np.linalg.norm(point - line[0]))
    share = ((point - start) * ends).sum(1) / (ends**2).sum(1).clip(1e-9)
    nearest = start + share.clip(0, 1)[:, None] * ends
    return float(np.linalg.norm(point - nearest, axis=1).min())


def find_inside(template: Points, places: Points) -> NDArray[np.bool_]:
    """Find which places [N, 2], from the picture's corner, are in the eyes of a template."""
    outlines = [template[list(eye)] + 0.5 for eye in EYES]
    inside: NDArray[np.bool_] = np.any([points_in_poly(places, one) for one in outlines], 0)
    return inside


def summarise(distances: Sequence[Mapping[str, Sequence[float]]]) -> dict[str, float]:
    """Median distance of each feature over the faces."""
    return {
        feature: float(np.median([value for one in distances for value in one[feature]]))
        for feature in LINES
    }
