"""Skin segmentation by a colour model of one face, learnt from its cheeks, nose and forehead."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.errors import InputError
from skinnet.images._arguments import check_photo
from skinnet.images._connected_parts import keep_large
from skinnet.images._face_skin import segment_face_skin
from skinnet.images._skin_colours import compute_features, fit_normal, measure_distance, step_down
from skinnet.images.box import Box
from skinnet.images.faces.face import Face
from skinnet.images.faces.framing import frame_head
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear

_FACE_SIZE = 96
"""Width of the face, in pixels, at which skin is segmented."""

_Rectangle = tuple[float, float, float, float]
"""Left, top, right, bottom, in pixels or in sides of the face's box."""

SKIN_AREAS: tuple[_Rectangle, ...] = (
    (0.18, 0.50, 0.38, 0.70),
    (0.62, 0.50, 0.82, 0.70),
    (0.42, 0.40, 0.58, 0.62),
    (0.35, 0.10, 0.65, 0.22),
)
"""Both cheeks, the nose, and the forehead, in sides of the face's box; where hair hides it, its
pixels are outliers."""


def segment_skin(photo: NDArray[np.uint8], face: Box | Face) -> NDArray[np.float32]:
    """Segment the skin of one face: the pseudo ground truth for training on photographs.

    The colour model is applied inside an ellipse around the head and a rectangle for the neck.
    Eyes, brows, hair, beard and lips are left out where their colours differ from the skin's. With
    landmarks, eyes, brows, nostrils, the open mouth and dense beards are left out by their places,
    highlights, stubble and the shadow below the chin are skin, and bare lips are.

    Args:
        photo: uint8 sRGB [H, W, 3].
        face: The face, as `find_faces` gives it, or its box from the brows to the chin.

    Returns:
        Probability of skin, float32 [H, W] in [0, 1].

    Raises:
        InputError: The photograph has another shape or type, or the face is neither.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import Box, segment_skin
        >>> mask = segment_skin(astronaut(), Box(176, 71, 268, 163))
        >>> bool(mask[125, 224] > 0.8), bool(mask[300, 200] < 0.2)  # nose, suit
        (True, True)
    """
    height, width = check_photo(photo).shape[:2]
    if not isinstance(face, Box | Face):
        raise InputError(f"face is a Face that find_faces gives, or a Box; got {face!r:.60}.")
    box = face.box if isinstance(face, Face) else face
    around = frame_head(box, width, height, margin=2.4)
    mask = np.zeros((height, width), np.float32)
    if min(around.width, around.height) < 1:
        return mask
    crop = photo[around.slices]
    coarse = _segment_crop(crop, around, box)
    if isinstance(face, Face):
        corner = np.array([around.left, around.top], np.float32)
        mask[around.slices] = segment_face_skin(crop, face.landmarks - corner, coarse)
    else:
        mask[around.slices] = resize(coarse, around.width, around.height).clip(0, 1)
    return mask


def _segment_crop(crop: NDArray[np.uint8], around: Box, face: Box) -> NDArray[np.float32]:
    """Probability of skin in a crop [H, W, 3], whose box is `around`, at a smaller size."""
    longer = max(crop.shape[:2])
    ratio = longer / round(_FACE_SIZE * longer / face.width)
    small = resize(crop, max(1, round(around.width / ratio)), max(1, round(around.height / ratio)))
    inside = [(value - start) / ratio for value, start in zip(face, around[:2] * 2, strict=True)]
    return _segment(small, (inside[0], inside[1], inside[2], inside[3]))


def _segment(crop: NDArray[np.uint8], face: _Rectangle) -> NDArray[np.float32]:
    """Probability of skin in uint8 sRGB [h, w, 3]; `face` is the face's box in its pixels."""
    linear = srgb_to_linear(crop) + 1e-3
    linear = ndimage.gaussian_filter(linear, (1, 1, 0))
    x, y = _face_coordinates(crop.shape[:2], face)
    seeds = np.any([_select(x, y, seed) for seed in SKIN_AREAS], 0)
    if not seeds.any():
        return np.zeros(crop.shape[:2], np.float32)
    mean, covariance = fit_normal(compute_features(linear)[seeds])
    distance = measure_distance(linear, mean, covariance)
    # Lips and teeth differ from skin mostly in redness, so at the mouth less deviation is allowed.
    mouth = np.exp(-(((x - 0.5) / 0.22) ** 4) - ((y - 0.82) / 0.08) ** 4)
    redness = np.abs(compute_features(linear)[..., 0] - mean[0]) / 0.05
    score = step_down(distance, 3.2, 0.35) * step_down(redness * mouth, 2.0, 0.3)
    score = score * _head_and_neck(x, y)
    return _clean(score)


def _face_coordinates(
    shape: tuple[int, ...], face: _Rectangle
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Coordinates of pixel centres in sides of the face's box."""
    rows, columns = np.mgrid[: shape[0], : shape[1]] + 0.5
    left, top, right, bottom = face
    return (columns - left) / (right - left), (rows - top) / (bottom - top)


def _select(x: NDArray[Any], y: NDArray[Any], area: _Rectangle) -> NDArray[np.bool_]:
    left, top, right, bottom = area
    inside: NDArray[np.bool_] = (x > left) & (x < right) & (y > top) & (y < bottom)
    return inside


def _head_and_neck(x: NDArray[Any], y: NDArray[Any]) -> NDArray[Any]:
    """An ellipse around the head and a rectangle for the neck, with soft edges."""
    head = np.hypot((x - 0.5) / 0.72, (y - 0.47) / 0.85)
    neck = np.maximum(np.abs(x - 0.5) / 0.42, np.abs(y - 1.15) / 0.4)
    return step_down(np.minimum(head, neck), 1.0, 0.03)


def _clean(score: NDArray[Any]) -> NDArray[np.float32]:
    """Keep the large connected parts, close their holes, and soften the edges."""
    large = keep_large(ndimage.binary_opening(score > 0.5, iterations=2), 0.06)
    closed = ndimage.binary_closing(large, iterations=2)
    return ndimage.gaussian_filter(closed.astype(np.float32), 1.0).clip(0, 1)
