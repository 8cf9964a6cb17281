"""Hemoglobin of a map in another state: its local distributions are moved and stretched."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.appearance._local_statistics import measure_local
from skinnet.images.faces._face_chart import extend_landmarks, locate_on_chart

_LEAST = 1e-4
"""Volume fraction below which logarithms are not taken."""

_MOST_CHANGE, _MOST_DETAIL = 2.0, 1.5
"""Largest log change of the local mean, and largest log ratio to it that is stretched."""

_LEAST_SPREAD, _MOST_SPREAD = -0.95, 5.0

Fields = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class BloodChange:
    """A change of hemoglobin over a face's chart; `DynamicModel.change` makes it.

    Attributes:
        mean: Log change of the local mean, [size, size].
        spread: Relative change of the local standard deviation of the logarithm, [size, size].
        landmarks: The chart's landmarks, from 0 to 1, [478, 2].
        window: Standard deviation of the local window in sides of the chart.
        amounts: The amount of each state, to be told.
    """

    mean: NDArray[np.float32]
    spread: NDArray[np.float32]
    landmarks: NDArray[np.float32]
    window: float
    amounts: dict[str, int | float]

    def __call__(
        self,
        hemoglobin: NDArray[np.float32],
        landmarks: NDArray[np.floating],
        skin: NDArray[np.floating],
        most: int | float,
    ) -> NDArray[np.float32]:
        """Change the hemoglobin of a picture.

        Args:
            hemoglobin: Volume fractions at rest, [h, w].
            landmarks: Columns and rows of the face's landmarks in pixels of the map, [478, 2].
            skin: Probability of skin, [h, w].
            most: The largest volume fraction of the model.

        Returns:
            The volume fractions, [h, w].
        """
        places, weight = locate_on_chart(landmarks, self.landmarks, hemoglobin.shape)
        mean, spread = (_lay_out(each, places, weight) for each in (self.mean, self.spread))
        sigma = self.window * _measure_chart(landmarks, self.landmarks)
        return stretch(hemoglobin, mean, spread, skin, sigma, most)


def _lay_out(
    field: Fields, places: NDArray[np.floating], weight: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Sample a field; beyond the rim skin changes as it does at the field's edges in the mean."""
    edges = np.concatenate([field[0], field[-1], field[:, 0], field[:, -1]])
    beyond = np.float32(edges.mean())
    return np.asarray(beyond + weight * (sample_field(field, places) - beyond), np.float32)


def sample_field(field: Fields, places: NDArray[np.floating]) -> NDArray[np.float32]:
    """Sample a field [size, size] linearly at places [..., 2] from 0 to 1, right and down."""
    at = np.moveaxis(places[..., ::-1], -1, 0) * len(field) - 0.5
    sampled = ndimage.map_coordinates(field, at, order=1, mode="nearest", output=np.float32)
    return np.asarray(sampled)


def stretch(
    hemoglobin: NDArray[np.float32],
    mean: Fields,
    spread: Fields,
    skin: NDArray[np.floating],
    sigma: float,
    most: int | float,
) -> NDArray[np.float32]:
    """Move the local mean of log hemoglobin, and stretch what differs from it.

    log f' = log f + mean + spread (log f - local mean of log f). So the local mean changes by
    `mean`, the local standard deviation by the factor 1 + `spread`, and fine structure stays.

    Args:
        hemoglobin: Volume fractions, [h, w].
        mean: Log change of the local mean, [h, w].
        spread: Relative change of the local standard deviation, [h, w].
        skin: How much each pixel counts in local means, [h, w].
        sigma: Standard deviation of the local window in pixels.
        most: Largest volume fraction; a larger one at rest does not grow.

    Source:
        Jimenez et al. 2010, who match local distributions by mean and standard deviation.
    """
    logs = np.log(np.maximum(hemoglobin, _LEAST))
    detail = np.zeros(logs.shape)
    if np.any(spread):
        local, _ = measure_local(logs, skin, sigma)
        detail = np.clip(logs - local, -_MOST_DETAIL, _MOST_DETAIL)
    moved = np.clip(mean, -_MOST_CHANGE, _MOST_CHANGE)
    change = moved + np.clip(spread, _LEAST_SPREAD, _MOST_SPREAD) * detail
    changed = hemoglobin * np.exp(change)
    top = np.maximum(hemoglobin, np.float32(most))
    return np.asarray(np.minimum(changed, top), np.float32)


def _measure_chart(landmarks: NDArray[np.floating], chart: NDArray[np.floating]) -> float:
    """Side of the chart in pixels of a picture with these landmarks."""
    own, shared = (extend_landmarks(each) for each in (landmarks, chart))
    return float(np.sqrt(own.var(0).sum() / shared.var(0).sum()))
