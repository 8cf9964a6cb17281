"""The guided filter: an image that follows the edges of a photograph, also at a larger size."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage

from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear

_BLACK = 0.02
"""Linear sRGB that is added before the logarithm, so that noise in black does not count."""

_STRIP = 128
"""Rows of the large photograph that are filtered at once, which bounds the memory."""

_FloatImage = NDArray[np.float32]


def make_guide(photo: NDArray[np.uint8]) -> _FloatImage:
    """Log colours of uint8 sRGB [..., 3] in [0, 1], in which dark skin and hair differ clearly."""
    levels = np.log(srgb_to_linear(np.arange(256, dtype=np.uint8)) + np.float32(_BLACK))
    levels -= levels[0]
    return np.take((levels / levels[-1]).astype(np.float32), photo)


class LinearModel(NamedTuple):
    """A linear function of the guide's colours around each pixel.

    Attributes:
        slopes: float32 [3, h, w].
        intercept: float32 [h, w].
    """

    slopes: _FloatImage
    intercept: _FloatImage


def fit_guide(guide: _FloatImage, image: _FloatImage, radius: int, epsilon: float) -> LinearModel:
    """Fit an image [h, w] by linear functions of the guide's colours [h, w, 3].

    Args:
        guide: Colours in [0, 1].
        image: What is to follow the guide's edges.
        radius: Windows are squares of 2 radius + 1 pixels.
        epsilon: Variance of the guide below which an edge is not followed.

    Returns:
        The mean of the functions of all windows around each pixel.

    Source:
        He, Sun and Tang 2010, "Guided image filtering", equations 14 to 16.
    """

    def average(plane: _FloatImage) -> _FloatImage:
        return ndimage.uniform_filter(plane, 2 * radius + 1, mode="mirror")

    planes = [np.ascontiguousarray(guide[..., index]) for index in range(3)]
    means, mean = [average(plane) for plane in planes], average(image)
    pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
    rr, rg, rb, gg, gb, bb = (
        average(planes[i] * planes[j]) - means[i] * means[j] + np.float32(epsilon * (i == j))
        for i, j in pairs
    )
    r, g, b = (
        average(plane * image) - each * mean for plane, each in zip(planes, means, strict=True)
    )
    # The inverse of a symmetric 3 x 3 matrix by its cofactors.
    c_rr, c_rg, c_rb = gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb
    c_gg, c_gb, c_bb = rr * bb - rb * rb, rb * rg - rr * gb, rr * gg - rg * rg
    scale = 1 / (rr * c_rr + rg * c_rg + rb * c_rb)
    slopes = [
        scale * (c_rr * r + c_rg * g + c_rb * b),
        scale * (c_rg * r + c_gg * g + c_gb * b),
        scale * (c_rb * r + c_gb * g + c_bb * b),
    ]
    intercept = mean - np.einsum("chw,chw->hw", slopes, means)
    return LinearModel(np.stack([average(slope) for slope in slopes]), average(intercept))


def filter_guided(
    guide: _FloatImage, image: _FloatImage, radius: int, epsilon: float
) -> _FloatImage:
    """Filter an image [h, w] by a guide [h, w, 3] of the same size; see `fit_guide`."""
    slopes, intercept = fit_guide(guide, image, radius, epsilon)
    filtered: _FloatImage = np.einsum("chw,hwc->hw", slopes, guide) + intercept
    return filtered


def enlarge_guided(
    photo: NDArray[np.uint8], image: _FloatImage, radius: int, epsilon: float
) -> _FloatImage:
    """Enlarge an image [h, w] in [0, 1] to the size of a photograph, whose edges it follows.

    Args:
        photo: uint8 sRGB [H, W, 3].
        image: What is enlarged, [h, w].
        radius: Radius of the windows, in pixels of the image.
        epsilon: See `fit_guide`.

    Returns:
        float32 [H, W] in [0, 1].

    Source:
        He and Sun 2015, "Fast guided filter": the functions are fitted at the small size.
    """
    (height, width), size = photo.shape[:2], (image.shape[1], image.shape[0])
    small = make_guide(resize(photo, *size))
    planes = [*(model := fit_guide(small, image, radius, epsilon)).slopes, model.intercept]
    enlarged = np.zeros((height, width), np.float32)
    scale = height / image.shape[0]
    used = np.flatnonzero(image.any(1)) if image.any() else np.zeros(1, np.intp)
    first = max(0, math.floor((used[0] - 2 * radius - 1) * scale))
    last = min(height, math.ceil((used[-1] + 2 * radius + 2) * scale))
    for top in range(first, last, _STRIP):
        rows = slice(top, min(top + _STRIP, last))
        *slopes, total = (enlarge_rows(plane, (height, width), rows) for plane in planes)
        guide = make_guide(photo[rows])
        for channel, slope in enumerate(slopes):
            total += slope * guide[..., channel]
        np.clip(total, 0, 1, out=enlarged[rows])
    return enlarged


def enlarge_rows(plane: _FloatImage, shape: tuple[int, ...], rows: slice) -> _FloatImage:
    """Rows of a plane resized bilinearly to a shape."""
    if plane.shape == tuple(shape[:2]):
        return plane[rows].copy()
    image, (height, width) = Image.fromarray(np.ascontiguousarray(plane)), shape[:2]
    scale = image.height / height
    box = (0, rows.start * scale, image.width, min(rows.stop * scale, image.height))
    size = (width, rows.stop - rows.start)
    return np.array(image.resize(size, Image.Resampling.BILINEAR, box=box))
