"""Colours of one person's skin: a normal distribution of log chromaticity and luminance."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images.srgb import LUMINANCE_WEIGHTS

_MIN_COVARIANCE = np.diag([0.06, 0.07, 0.32]) ** 2
"""Least covariance of log R/G, log B/G and log luminance: shading and noise of even skin."""

_SPECULAR_SHARES = (0.0, 0.15, 0.3, 0.45, 0.6)
"""Shares of a pixel's darkest channel that are tried as white specular reflection."""


def compute_features(linear: NDArray[Any]) -> NDArray[Any]:
    """Log R/G, log B/G and log luminance of linear sRGB."""
    red, green, blue = np.moveaxis(np.log(linear), -1, 0)
    return np.stack([red - green, blue - green, np.log(linear @ LUMINANCE_WEIGHTS)], -1)


def fit_normal(samples: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Mean and covariance of the samples; outliers are removed three times."""
    luminance = samples[:, 2]
    middle = np.quantile(luminance, 0.5, method="lower")  # a sample's own, so that some are kept
    kept = samples[np.abs(luminance - middle) < 1.0]
    for _ in range(3):
        covariance = np.cov(kept.T, ddof=0) + _MIN_COVARIANCE
        difference = samples - np.median(kept, 0)
        square = np.einsum("ni,ij,nj->n", difference, np.linalg.inv(covariance), difference)
        kept = samples[square < 7] if (square < 7).any() else kept
    return kept.mean(0), np.cov(kept.T, ddof=0) + _MIN_COVARIANCE


def measure_distance(
    linear: NDArray[Any], mean: NDArray[Any], covariance: NDArray[Any]
) -> NDArray[Any]:
    """Mahalanobis distance to the skin; bright pixels may have a specular part."""
    inverse = np.linalg.inv(covariance)
    best = np.full(linear.shape[:2], np.inf)
    bright = compute_features(linear)[..., 2] > mean[2]
    for share in _SPECULAR_SHARES:
        difference = compute_features(linear - share * linear.min(-1, keepdims=True)) - mean
        square = np.einsum("hwi,ij,hwj->hw", difference, inverse, difference)
        best = np.minimum(best, np.where(bright | (share == 0), square, np.inf))
    distance: NDArray[Any] = np.sqrt(best)
    return distance


def step_down(value: NDArray[Any], middle: float, width: float) -> NDArray[Any]:
    """A smooth step from 1 below `middle` to 0 above it."""
    return 1 / (1 + np.exp(np.clip((value - middle) / width, -30, 30)))
