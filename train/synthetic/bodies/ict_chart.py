"""Where the skin of ICT-FaceKit's heads lies on the chart that faces are painted on."""

import numpy as np
from jaxtyping import Float, Int
from scipy.interpolate import RBFInterpolator

LANDMARK_PLACES: tuple[tuple[tuple[int, ...], tuple[float, float]], ...] = (
    ((42,), (0.205, 0.012)), ((45,), (0.475, 0.028)), ((43,), (0.295, 0.060)),
    ((44,), (0.385, 0.062)), ((46,), (0.385, -0.018)), ((47,), (0.295, -0.018)),
    ((22,), (0.13, 0.195)), ((23,), (0.24, 0.205)), ((24,), (0.36, 0.208)),
    ((25,), (0.47, 0.205)), ((26,), (0.58, 0.185)),
    ((27,), (0.0, 0.04)), ((28,), (0.0, -0.08)), ((29,), (0.0, -0.20)), ((30,), (0.0, -0.33)),
    ((33,), (0.0, -0.47)), ((34,), (0.065, -0.452)), ((35,), (0.14, -0.43)),
    ((54,), (0.205, -0.655)), ((51,), (0.0, -0.600)), ((52,), (0.065, -0.588)),
    ((53,), (0.135, -0.615)), ((62, 66), (0.0, -0.66)), ((63, 65), (0.085, -0.66)),
    ((55,), (0.14, -0.710)), ((56,), (0.075, -0.732)), ((57,), (0.0, -0.738)),
    ((8,), (0.0, -1.10)),
)  # fmt: skip
"""Landmarks of the mean head and the azimuth and elevation at which they are painted.

Numbers are those of iBUG's 68 landmarks on the left side of the face. Several numbers stand for the
mean of their landmarks."""


def chart_skin(
    mean: Float[np.ndarray, "vertices 3"], landmarks: Int[np.ndarray, "68"]
) -> Float[np.ndarray, "vertices 2"]:
    """Find the place of each vertex on the chart of `skinnet.shape._procedural_head`.

    A thin-plate spline takes the mean head's own angles to those at which its features are painted.

    Args:
        mean: Vertices of the mean head in half heads.
        landmarks: Vertices of iBUG's 68 landmarks.

    Returns:
        Azimuth and elevation of each vertex in radians.
    """
    own = _measure_angles(mean)
    marks = _measure_angles(mean[landmarks])
    pairs = [(marks[list(numbers)].mean(0), place) for numbers, place in LANDMARK_PLACES]
    pairs += [(np.array(angles), place) for angles, place in _EARS]
    pairs += [(np.array(place), place) for place in _list_anchors()]
    angles = np.array([angles for angles, _ in pairs])
    places = np.array([place for _, place in pairs])
    # Both sides of the face; points on its middle line are used once.
    source, once = np.unique(
        np.concatenate([angles, angles * [-1, 1]]).round(9), axis=0, return_index=True
    )
    target = np.concatenate([places, places * [-1, 1]])[once]
    spline = RBFInterpolator(source, target, kernel="thin_plate_spline", smoothing=1e-6)
    chart = np.asarray(spline(own))
    chart[:, 1] -= 0.4 * (-1.02 - mean[:, 1]).clip(0)
    return chart


_EARS = (((1.61, -0.20), (1.5, -0.10)), ((1.61, 0.06), (1.5, 0.11)), ((1.58, -0.46), (1.5, -0.30)),
         ((1.44, -0.20), (1.36, -0.12)), ((1.76, -0.20), (1.64, -0.12)))  # fmt: skip
"""Middle, top, lobe, front and back of the ear: the mean head's own angles, and the chart's."""


def _list_anchors() -> list[tuple[float, float]]:
    """Places far from the features, which keep the mean head's own angles."""
    around = [(a, e) for a in (2.0, 2.6, np.pi) for e in (-1.2, -0.8, -0.4, 0.0, 0.4, 0.8)]
    top = [(a, e) for a in (0.0, 0.5, 1.0, 1.5, 2.2, np.pi) for e in (0.65, 1.0, 1.3)]
    return around + top + [(0.9, -0.85), (1.1, -0.5), (1.0, 0.35), (0.5, -1.25), (1.5, -0.9)]


def _measure_angles(points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
    length = np.linalg.norm(points, axis=1).clip(1e-9)
    return np.stack(
        [np.arctan2(points[:, 0], points[:, 2]), np.arcsin((points[:, 1] / length).clip(-1, 1))], 1
    )
