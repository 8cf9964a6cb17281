"""BlazeFace: where faces are, and how they are turned."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._face_models import run_face_model
from skinnet.images.faces._turned_square import TurnedSquare

_SIZE = 256
"""Side of the network's input, in pixels."""

_ANCHORS = ((16, 2), (8, 6))
"""Cells across each grid of the network, and its anchors in each cell."""

_SAME_FACE = 0.3
"""Overlap (intersection over union) of detections of one face."""


class Detection(NamedTuple):
    """A detected face.

    Attributes:
        square: A square around it, from the brows to the chin, turned as the face.
        score: Probability of a face.
    """

    square: TurnedSquare
    score: float


def detect_faces(
    photo: NDArray[np.uint8], view: TurnedSquare, least_score: float
) -> list[Detection]:
    """Detect faces in a square of a photograph, uint8 sRGB [H, W, 3].

    Source:
        BlazeFace for the back camera (Bazarevsky et al. 2019), as MediaPipe publishes it.
    """
    image = view.cut(photo, _SIZE).astype(np.float32) / np.float32(127.5) - 1
    outputs = run_face_model("face_detector", image)
    scores = 1 / (1 + np.exp(-outputs["classificators"][0, :, 0].clip(-80, 80)))
    chosen = scores >= least_score
    points = outputs["regressors"][0, chosen].reshape(-1, 8, 2)
    points[:, [0, 2, 3]] += _SIZE * _make_anchors()[chosen, None]
    return [
        Detection(_to_square(points, view), score)
        for points, score in _merge(points, scores[chosen])
    ]


@cache
def _make_anchors() -> NDArray[np.float32]:
    """Centres of the anchors [896, 2], in sides of the input."""
    grids = []
    for cells, each in _ANCHORS:
        place = (np.arange(cells, dtype=np.float32) + 0.5) / cells
        grid = np.stack(np.meshgrid(place, place), -1).reshape(-1, 2)
        grids.append(grid.repeat(each, 0))
    anchors: NDArray[np.float32] = np.concatenate(grids).astype(np.float32)
    return anchors


def _merge(
    points: NDArray[np.float32], scores: NDArray[np.float32]
) -> list[tuple[NDArray[np.float32], float]]:
    """Merge the detections of each face to their mean, weighed by the scores."""
    merged = []
    order = np.argsort(-scores, kind="stable")
    points, scores = points[order], scores[order]
    while len(scores):
        same = _overlap_first(points) > _SAME_FACE
        same[0] = True
        weights = scores[same, None, None]
        merged.append(((weights * points[same]).sum(0) / weights.sum(), float(scores[0])))
        points, scores = points[~same], scores[~same]
    return merged


def _overlap_first(points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Intersection over union of each box with the first one."""
    centre, half = points[:, 0], points[:, 1] / 2
    low, high = centre - half, centre + half
    shared = (np.minimum(high, high[0]) - np.maximum(low, low[0])).clip(0).prod(1)
    area = points[:, 1].prod(1)
    overlap: NDArray[np.float32] = shared / (area + area[0] - shared).clip(1e-6)
    return overlap


def _to_square(points: NDArray[np.float32], view: TurnedSquare) -> TurnedSquare:
    centre, right_eye, left_eye = view.place(points[[0, 2, 3]], _SIZE)
    side = float(points[1].max()) * view.side / _SIZE
    across = left_eye - right_eye
    tilt = float(np.arctan2(across[1], across[0]))
    return TurnedSquare(float(centre[0]), float(centre[1]), side, tilt)
