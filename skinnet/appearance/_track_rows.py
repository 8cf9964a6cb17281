"""Regions of a face over time, as `skinnet track` writes them, spread over the chart."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.errors import InputError
from skinnet.images.faces._face_regions import locate_region

REGIONS = ("forehead", "left_cheek", "right_cheek", "nose", "lips", "chin")
"""Left and right are the person's."""

_BLUR = 0.045
"""Reach of a region in sides of the chart."""

Array = NDArray[np.float64]


def read_track_rows(path: Path) -> tuple[Array, Array]:
    """Read the table of `skinnet track`.

    Returns:
        Times in seconds [frames], and log ratios of hemoglobin to the baseline [frames, regions];
        NaN where a region was not read.

    Raises:
        InputError: It cannot be read, or is no such table.
    """
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        times = np.array([float(row["time"]) for row in rows])
        ratios = np.array(
            [[float(row[f"{name}_log_ratio"] or "nan") for name in REGIONS] for row in rows]
        )
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); check the path.") from error
    except (KeyError, ValueError, TypeError, csv.Error) as error:
        raise InputError(
            f"{path} is no table of skinnet track, which has the columns time and "
            "forehead_log_ratio; give the .csv that it wrote."
        ) from error
    if not len(times):
        raise InputError(f"{path} has no rows; give the .csv of a video that was read.")
    return times, ratios


def spread_regions(ratios: Array, landmarks: NDArray[np.floating], size: int) -> Array:
    """Spread values of the regions smoothly over a chart; their means in the regions stay.

    Args:
        ratios: Values, [frames, regions]; a region that is NaN has the mean of the others.
        landmarks: The chart's landmarks, from 0 to 1, [478, 2].
        size: Side of the chart.

    Returns:
        Values, [frames, size, size]; NaN in frames without any region.
    """
    masks = _mark_regions(landmarks, size).reshape(len(REGIONS), -1)
    average = masks / masks.sum(1, keepdims=True)
    reach = _blur(masks.reshape(-1, size, size), _BLUR * size).reshape(len(REGIONS), -1) + 1e-4
    share = reach / reach.sum(0)
    weights = np.linalg.solve(average @ share.T, share)
    known = np.isfinite(ratios)
    middle = np.where(known, ratios, 0).sum(1) / np.maximum(known.sum(1), 1)
    filled = np.where(known, ratios, middle[:, None])
    filled[~known.any(1)] = np.nan
    return np.asarray((filled @ weights).reshape(-1, size, size))


def _mark_regions(landmarks: NDArray[np.floating], size: int) -> NDArray[np.float64]:
    masks = np.zeros((len(REGIONS), size, size))
    for mask, name in zip(masks, REGIONS, strict=True):
        patch = locate_region((size * landmarks).astype(np.float32), name).clip(size, size)
        mask[patch.box.slices] = patch.inside
    return masks


def _blur(masks: Array, sigma: float) -> Array:
    return np.stack([ndimage.gaussian_filter(mask, sigma) for mask in masks])
