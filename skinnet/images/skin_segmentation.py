"""A colour model of one face's skin, learnt from its cheeks and nose."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.photograph import srgb_to_linear

Rectangle = tuple[float, float, float, float]
"""Left, top, right, bottom, in pixels or in sides of the face's box."""

_SEEDS: tuple[Rectangle, ...] = (
    (0.18, 0.50, 0.38, 0.70),
    (0.62, 0.50, 0.82, 0.70),
    (0.42, 0.40, 0.58, 0.62),
    (0.35, 0.10, 0.65, 0.22),
)
"""Both cheeks, the nose, and the forehead, which the trimming drops where hair hides it."""

_FLOOR = np.diag([0.06, 0.07, 0.32]) ** 2
"""Least variance of log R/G, log B/G and log luminance: shading and noise of an even skin."""

_GLOSS = (0.0, 0.15, 0.3, 0.45, 0.6)
"""Shares of a pixel's least channel that are tried as white gloss."""


def skin_likeness(crop: NDArray[np.uint8], face: Rectangle) -> NDArray[np.float32]:
    """Likeness to the skin of the face in uint8 sRGB [H, W, 3], float32 [H, W] in [0, 1].

    `face` is the face's box in pixels of the crop, some 100 of them wide.
    """
    linear = srgb_to_linear(crop) + 1e-3
    linear = ndimage.gaussian_filter(linear, (1, 1, 0))
    x, y = _face_coordinates(crop.shape[:2], face)
    seeds = np.any([_within(x, y, seed) for seed in _SEEDS], 0)
    if not seeds.any():
        return np.zeros(crop.shape[:2], np.float32)
    centre, covariance = _robust_normal(_features(linear)[seeds])
    distance = _distance(linear, centre, covariance)
    # Lips and teeth differ from skin by little but redness: at the mouth, less of that passes.
    mouth = np.exp(-(((x - 0.5) / 0.22) ** 4) - ((y - 0.82) / 0.08) ** 4)
    redness = np.abs(_features(linear)[..., 0] - centre[0]) / 0.05
    score = _falling(distance, 3.2, 0.35) * _falling(redness * mouth, 2.0, 0.3)
    score = score * _place(x, y)
    return _tidy(score)


def _features(linear: NDArray[Any]) -> NDArray[Any]:
    """log R/G, log B/G and log luminance of linear sRGB."""
    red, green, blue = np.moveaxis(np.log(linear), -1, 0)
    return np.stack([red - green, blue - green, np.log(linear @ [0.2126, 0.7152, 0.0722])], -1)


def _robust_normal(samples: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Mean and covariance after dropping what lies far out, three times."""
    luminance = samples[:, 2]
    middle = np.quantile(luminance, 0.5, method="lower")  # one of them, so that some are kept
    kept = samples[np.abs(luminance - middle) < 1.0]
    for _ in range(3):
        covariance = np.cov(kept.T, ddof=0) + _FLOOR
        away = samples - np.median(kept, 0)
        near = np.einsum("ni,ij,nj->n", away, np.linalg.inv(covariance), away) < 7
        kept = samples[near] if near.any() else kept
    return kept.mean(0), np.cov(kept.T, ddof=0) + _FLOOR


def _distance(linear: NDArray[Any], centre: NDArray[Any], covariance: NDArray[Any]) -> NDArray[Any]:
    """Mahalanobis distance to the skin, with or without some gloss on bright pixels."""
    inverse = np.linalg.inv(covariance)
    best = np.full(linear.shape[:2], np.inf)
    bright = _features(linear)[..., 2] > centre[2]
    for share in _GLOSS:
        away = _features(linear - share * linear.min(-1, keepdims=True)) - centre
        square = np.einsum("hwi,ij,hwj->hw", away, inverse, away)
        best = np.minimum(best, np.where(bright | (share == 0), square, np.inf))
    distance: NDArray[Any] = np.sqrt(best)
    return distance


def _face_coordinates(shape: tuple[int, ...], face: Rectangle) -> tuple[NDArray[Any], NDArray[Any]]:
    rows, columns = np.mgrid[: shape[0], : shape[1]] + 0.5
    left, top, right, bottom = face
    return (columns - left) / (right - left), (rows - top) / (bottom - top)


def _within(x: NDArray[Any], y: NDArray[Any], area: Rectangle) -> NDArray[np.bool_]:
    left, top, right, bottom = area
    inside: NDArray[np.bool_] = (x > left) & (x < right) & (y > top) & (y < bottom)
    return inside


def _falling(value: NDArray[Any], middle: float, width: float) -> NDArray[Any]:
    """One below `middle`, zero above it."""
    return 1 / (1 + np.exp(np.clip((value - middle) / width, -30, 30)))


def _place(x: NDArray[Any], y: NDArray[Any]) -> NDArray[Any]:
    """An ellipse that holds the head, and a strip for the neck."""
    head = np.hypot((x - 0.5) / 0.72, (y - 0.47) / 0.85)
    neck = np.maximum(np.abs(x - 0.5) / 0.42, np.abs(y - 1.15) / 0.4)
    return _falling(np.minimum(head, neck), 1.0, 0.03)


def _tidy(score: NDArray[Any]) -> NDArray[np.float32]:
    """The large pieces, without crumbs and pinholes, with soft edges."""
    solid = ndimage.binary_opening(score > 0.5, iterations=2)
    labels, count = ndimage.label(solid)
    if count == 0:
        return np.zeros(score.shape, np.float32)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)
    sizes[0] = 0
    large = np.isin(labels, np.flatnonzero(sizes > 0.06 * sizes.max()))
    closed = ndimage.binary_closing(large, iterations=2)
    return ndimage.gaussian_filter(closed.astype(np.float32), 1.0).clip(0, 1)
