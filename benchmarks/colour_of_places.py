"""A linear map from the colours of 25 places in one picture to a value of the other.

It is what can be read without a network: whatever a person's skin, background, cloth and eyes say
together about the person's skin in another photograph.
"""

import numpy as np
from numpy.typing import NDArray

from benchmarks.face_photographs import (
    FacePhotograph,
    describe_colour,
    measure_colour,
    measure_patch,
    measure_regions,
)
from skinnet.images import srgb_to_linear
from skinnet.images.srgb import LUMINANCE_WEIGHTS

PLACES = 25

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)
"""Percentiles of luminance whose colours are places."""

_CORNERS = {
    "left wall": (slice(0.02, 0.2), slice(0.02, 0.12)),
    "right wall": (slice(0.02, 0.2), slice(0.88, 0.98)),
    "wall above": (slice(0.0, 0.05), slice(0.3, 0.7)),
    "left shoulder": (slice(0.85, 1.0), slice(0.05, 0.3)),
    "collar": (slice(0.9, 1.0), slice(0.4, 0.6)),
    "right shoulder": (slice(0.85, 1.0), slice(0.7, 0.95)),
}
"""Rows and columns of background and cloth, as shares of the picture."""

RIDGES = np.logspace(-1, 4, 21)

Matrix = NDArray[np.floating]


def measure_places(face: FacePhotograph) -> NDArray[np.float64]:
    """Measure log R/G, log B/G and log G of 25 places [75]; NaN for what is hidden."""
    photo, parts = face.photo, face.parts
    linear = srgb_to_linear(photo)
    colours = [
        *measure_regions(photo, parts).values(),
        *(_measure_rectangle(linear, *part) for part in _CORNERS.values()),
        *_measure_percentiles(linear),
        measure_colour(photo, face.skin),
        measure_patch(photo, tuple(parts.sclera)),
        _measure_whitest(photo, face),
        linear.mean((0, 1)),
    ]
    assert len(colours) == PLACES
    return describe_colour(np.stack(colours)).ravel()


def _measure_rectangle(linear: Matrix, rows: slice, columns: slice) -> Matrix:
    row, column = (
        slice(int(part.start * side), max(int(part.stop * side), int(part.start * side) + 1))
        for part, side in zip((rows, columns), linear.shape[:2], strict=True)
    )
    return np.median(linear[row, column].reshape(-1, 3), 0)


def _measure_percentiles(linear: Matrix) -> list[Matrix]:
    """Mean colours of the pixels about each percentile of luminance."""
    pixels = linear.reshape(-1, 3)
    ordered = pixels[np.argsort(pixels @ LUMINANCE_WEIGHTS)]
    half = max(len(ordered) // 200, 1)
    places = [min(int(share * len(ordered) / 100), len(ordered) - 1) for share in PERCENTILES]
    return [ordered[max(place - half, 0) : place + half].mean(0) for place in places]


def _measure_whitest(photo: NDArray[np.uint8], face: FacePhotograph) -> Matrix:
    """Colour of the brightest tenth of the eyes' whites."""
    pixels = [photo[box.slices][inside] for box, inside in face.parts.sclera]
    joined = srgb_to_linear(np.concatenate([np.zeros((0, 3), np.uint8), *pixels]))
    if not len(joined):
        return np.full(3, np.nan)
    light = joined @ LUMINANCE_WEIGHTS
    return joined[light >= np.quantile(light, 0.9)].mean(0)


class LinearMap:
    """Ridge regression; what is missing is replaced by the mean of training.

    Args:
        features: Features of training [samples, features], NaN where missing.
        target: What is predicted [samples].

    Source:
        The ridge is chosen by generalised cross-validation (Golub, Heath & Wahba 1979, doi
        10.1080/00401706.1979.10489751).
    """

    def __init__(self, features: Matrix, target: Matrix) -> None:
        usable = np.isfinite(target)
        features, target = features[usable], target[usable]
        self.mean, self.spread = np.nanmean(features, 0), np.nanstd(features, 0).clip(1e-6)
        self.offset = target.mean()
        u, s, vt = np.linalg.svd(self._standardise(features), full_matrices=False)
        projected = u.T @ (target - self.offset)
        self.ridge = min(RIDGES, key=lambda ridge: _validate(s, projected, target, ridge))
        self.weights = vt.T @ (s / (s**2 + self.ridge) * projected)

    def __call__(self, features: Matrix) -> Matrix:
        """Predict [samples]."""
        return self._standardise(features) @ self.weights + self.offset

    def _standardise(self, features: Matrix) -> Matrix:
        return np.nan_to_num((features - self.mean) / self.spread)


def _validate(s: Matrix, projected: Matrix, target: Matrix, ridge: float) -> float:
    shrunk = s**2 / (s**2 + ridge)
    centred = target - target.mean()
    error = centred @ centred - projected @ projected + (((1 - shrunk) * projected) ** 2).sum()
    return float(error / (len(target) - 1 - shrunk.sum()) ** 2)


def map_to_other(train: tuple[Matrix, Matrix], test: Matrix) -> Matrix:
    """Fit a map from each photograph to the person's other one, and apply it to other people.

    Args:
        train: Features [people, 2, features] and targets [people, 2] of training.
        test: Features of the people it is applied to.

    Returns:
        Predictions [people, 2], each from one photograph.
    """
    features, target = train
    width = features.shape[-1]
    fitted = LinearMap(features.reshape(-1, width), target[:, ::-1].ravel())
    return fitted(test.reshape(-1, width)).reshape(test.shape[:2])
