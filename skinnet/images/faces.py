"""Faces in a photograph: detect one and place a square around its head."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import data
from skimage.feature import Cascade

from skinnet.images.box import Box
from skinnet.images.resizing import resize

HEAD_CENTRE = 0.45
"""Distance from the top of the face's box down to the head's centre, in heights of that box. The
head's centre is half-way from the top of the hair to the chin."""

_DETECTION_SIZE = 320
"""Longer side, in pixels, of the picture in which faces are detected."""

_PASSES = ((0.12, 1.1, 4), (0.25, 1.05, 3))
"""Smallest face relative to the shorter side, ratio of successive scales, and number of detections
that must agree. The second pass, for large faces only, runs if the first one finds none."""


def find_face(photo: NDArray[np.uint8]) -> Box | None:
    """Find the largest and most central face that is upright and frontal.

    A detection must be confirmed in the mirrored picture, which rejects most false ones.

    Args:
        photo: uint8 sRGB [H, W, 3].

    Returns:
        A square box from the brows to the chin, which may exceed the photograph by a rounding
        error; None if there is no face of at least an eighth of the shorter side.

    Source:
        Cascade of local binary patterns (Liao et al. 2007), as scikit-image ships it.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import find_face
        >>> find_face(astronaut())
        Box(left=170, top=62, right=277, bottom=169)
    """
    ratio = max(max(photo.shape[:2]) / _DETECTION_SIZE, 0.5)  # enlarge by 2 at most
    height, width = (max(1, round(side / ratio)) for side in photo.shape[:2])
    small = resize(photo, width, height)
    for smallest, step, agreeing in _PASSES:
        detected = _detect(small, smallest * min(small.shape[:2]), step, agreeing)
        faces = [face for face in detected if _confirm_in_mirror(small, face)]
        if faces:
            best = max(faces, key=lambda face: _score(face, small.shape))
            return _to_box(best, ratio)
    return None


def frame_head(face: Box, width: int, height: int, margin: float = 2.0) -> Box:
    """Place a square around the head, and clip it to the photograph.

    Args:
        face: The face's box, from the brows to the chin.
        width: Columns of the photograph.
        height: Rows of the photograph.
        margin: Side of the square in sides of the face's box; at 1.4 or more, hair and chin of an
            upright head are inside.

    Returns:
        The square, or the part of it that is inside the photograph.

    Example:
        >>> from skinnet.images import Box, frame_head
        >>> frame_head(Box(40, 40, 60, 60), 100, 100)
        Box(left=30, top=29, right=70, bottom=69)
    """
    half = margin * max(face.width, face.height) / 2
    x = (face.left + face.right) / 2
    y = face.top + HEAD_CENTRE * face.height
    return Box(
        max(0, round(x - half)),
        max(0, round(y - half)),
        min(width, round(x + half)),
        min(height, round(y + half)),
    )


def _detect(
    small: NDArray[np.uint8], smallest: float, step: float, agreeing: int
) -> list[dict[str, int]]:
    """Detect faces as squares (r, c, width, height) that are at least `smallest` pixels wide."""
    least, most = max(24, round(smallest)), min(small.shape[:2])
    if most < least:
        return []
    detected: list[dict[str, int]] = _load_cascade().detect_multi_scale(
        small, step, 1, (least, least), (most, most), min_neighbor_number=agreeing
    )
    return detected


def _confirm_in_mirror(small: NDArray[np.uint8], face: dict[str, int]) -> bool:
    top, left, side = face["r"], face["c"], face["width"]
    edge = round(0.35 * side)
    rows = slice(max(0, top - edge), top + side + edge)
    columns = slice(max(0, left - edge), left + side + edge)
    mirrored = np.ascontiguousarray(small[rows, columns][:, ::-1])
    return bool(_detect(mirrored, 0.7 * side, 1.05, 3))


def _score(face: dict[str, int], shape: tuple[int, ...]) -> float:
    """Width of a detection, times a weight that falls to one half at the picture's corners."""
    distance = np.hypot(
        (face["r"] + face["height"] / 2) / shape[0] - 0.5,
        (face["c"] + face["width"] / 2) / shape[1] - 0.5,
    )
    return float(face["width"] * (1 - distance / np.sqrt(2)))


def _to_box(face: dict[str, int], ratio: float) -> Box:
    left, top, side = (round(face[key] * ratio) for key in ("c", "r", "width"))
    return Box(left, top, left + side, top + side)


@cache
def _load_cascade() -> Any:
    return Cascade(data.lbp_frontal_face_cascade_filename())  # type: ignore[no-untyped-call]
