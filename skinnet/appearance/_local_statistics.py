"""Local means and standard deviations of a map, over skin alone."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

_LEAST = 1e-6

Array = NDArray[np.floating]


def measure_local(
    values: Array, weight: Array, sigma: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Measure the mean and the standard deviation around each place.

    Args:
        values: A map, [h, w]; what has no weight may be anything finite.
        weight: How much each place counts, at least 0, [h, w].
        sigma: Standard deviation of the Gaussian window in pixels.

    Returns:
        Both, [h, w].
    """
    counted, known = weight.astype(np.float64), values.astype(np.float64)
    share = _blur(counted, sigma) + _LEAST
    mean = _blur(counted * known, sigma) / share
    square = _blur(counted * (known - mean) ** 2, sigma) / share
    return mean, np.sqrt(square)


def _blur(values: NDArray[np.float64], sigma: float) -> NDArray[np.float64]:
    blurred: NDArray[np.float64] = ndimage.gaussian_filter(
        values, max(sigma, 1e-3), mode="constant", truncate=3
    )
    return blurred
