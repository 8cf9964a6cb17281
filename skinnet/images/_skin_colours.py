"""Colours of skin as normal distributions: of all people's, and of one person's."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.srgb import LUMINANCE_WEIGHTS

_MIN_COVARIANCE = np.diag([0.06, 0.07, 0.32]) ** 2
"""Least covariance of log R/G, log B/G and log luminance: shading and noise of even skin."""

USUAL_RATIOS = np.array([0.757, -0.296])
_SKIN_PRECISION = np.array([[37.1, 13.6], [13.6, 33.4]])
"""log R/G and log B/G of skin in portraits of all tones: mean and inverse covariance."""

_SPECULAR_SHARES = (0.15, 0.3, 0.45, 0.6, 0.75, 0.9)
"""Shares of a pixel's darkest channel that are tried as white specular reflection."""

_LOWEST, _BIN, _BINS = np.array([-1.2, -3.0, -7.2]), np.array([0.1, 0.1, 0.3]), (34, 42, 26)
"""Bins of log R/G, log B/G and log luminance: lower end, widths, numbers."""

_UNSEEN = 0.2
"""Share of other things whose colours no pixel shows that is known to be no skin."""

_Array = NDArray[Any]


def compute_features(linear: _Array) -> _Array:
    """Log R/G, log B/G and log luminance of linear sRGB."""
    red, green, blue = np.moveaxis(np.log(linear), -1, 0)
    return np.stack([red - green, blue - green, np.log(linear @ LUMINANCE_WEIGHTS)], -1)


def measure_usual_squares(ratios: _Array) -> _Array:
    """Squared Mahalanobis distances [...] of log R/G and log B/G [..., 2] from all skin."""
    difference = ratios - USUAL_RATIOS
    squares: _Array = np.einsum("...i,ij,...j->...", difference, _SKIN_PRECISION, difference)
    return squares


def fit_normal(samples: _Array) -> tuple[_Array, _Array]:
    """Mean and covariance of the samples; outliers are removed three times."""
    luminance = samples[:, 2]
    middle = np.quantile(luminance, 0.5, method="lower")  # a sample's own, so that some are kept
    kept = samples[np.abs(luminance - middle) < 1.0]
    for _ in range(3):
        covariance = np.cov(kept.T, ddof=0) + _MIN_COVARIANCE
        square = _measure_squares(samples - np.median(kept, 0), covariance)
        kept = samples[square < 7] if (square < 7).any() else kept
    return kept.mean(0), np.cov(kept.T, ddof=0) + _MIN_COVARIANCE


def measure_distance(linear: _Array, mean: _Array, covariance: _Array) -> _Array:
    """Mahalanobis distance [h, w] to the skin; bright pixels may have a specular part."""
    features = compute_features(linear)
    best = _measure_squares(features - mean, covariance)
    bright = features[..., 2] > mean[2]
    pixels, least = linear[bright], best[bright]
    for share in _SPECULAR_SHARES:
        diffuse = pixels - share * pixels.min(-1, keepdims=True)
        least = np.minimum(least, _measure_squares(compute_features(diffuse) - mean, covariance))
    best[bright] = least
    distance: _Array = np.sqrt(best)
    return distance


def compute_log_density(distance: _Array, covariance: _Array) -> _Array:
    """Log density of a normal distribution at Mahalanobis distances."""
    norm = 0.5 * float(np.log(np.linalg.det(2 * np.pi * covariance)))
    density: _Array = -0.5 * distance**2 - norm
    return density


def estimate_log_density(features: _Array, known: NDArray[np.bool_]) -> _Array:
    """Log density of other things at all pixels [h, w], from those known to be no skin."""
    place = np.clip((features - _LOWEST) / _BIN, 0, np.array(_BINS) - 1).astype(np.intp)
    index = np.ravel_multi_index(tuple(np.moveaxis(place, -1, 0)), _BINS)
    counts = np.bincount(index[known], minlength=int(np.prod(_BINS))).reshape(_BINS)
    seen = ndimage.gaussian_filter(counts / max(1, counts.sum()), 0.8).ravel()
    density = ((1 - _UNSEEN) * seen + _UNSEEN / np.prod(_BINS)) / np.prod(_BIN)
    log_density: _Array = np.log(density[index])
    return log_density


def step_down(value: _Array, middle: float, width: float) -> _Array:
    """A smooth step from 1 below `middle` to 0 above it."""
    return 1 / (1 + np.exp(np.clip((value - middle) / width, -30, 30)))


def _measure_squares(difference: _Array, covariance: _Array) -> _Array:
    """Squared Mahalanobis distances [...] of differences [..., 3]."""
    weighed = difference @ np.linalg.inv(covariance)
    squares: _Array = np.einsum("...i,...i->...", weighed, difference)
    return squares
