"""Errors of the regions' colours that stay for seconds, from how patches of a region differ."""

import numpy as np
from numpy.typing import NDArray

from skinnet.video._regions import FACE, NAMES
from skinnet.video._texture_space import SIZE

_PATCH = 8
"""Side of a patch in texels."""

_LEAST_FILLED = 0.25
"""Least part of a patch that is in a region for it to count."""

_SMOOTH, _SECONDS = 0.5, 2.0
"""Seconds over which a patch is smoothed, and over which the covariance is averaged."""

Array = NDArray[np.float64]


class SlowErrors:
    """Covariance of slow errors of log RGB [regions, 3, 3]; its memory does not grow.

    Compression codes blocks apart, and holds the error of each for many frames, which differences
    between frames do not see. So do spots of gloss and skin that slides below the mesh. But blood
    changes smoothly over a region: what its patches differ by, when the noise of single frames is
    smoothed away, is error. The errors of patches are taken as independent, so that the mean of a
    region has their variance over their number.

    Args:
        regions: Texels of each region, bool [regions, texels].
        inside: Which texels of the texture are covered, bool [size, size].
    """

    def __init__(self, regions: NDArray[np.bool_], inside: NDArray[np.bool_]) -> None:
        rows, columns = np.nonzero(inside)
        patch = rows // _PATCH * SIZE + columns // _PATCH
        pairs = [
            (index, np.flatnonzero(mask & (patch == number)))
            for index, mask in enumerate(regions)
            if NAMES[index] != FACE
            for number in np.unique(patch[mask])
        ]
        kept = [(index, texels) for index, texels in pairs
                if len(texels) >= _LEAST_FILLED * _PATCH**2]  # fmt: skip
        self._region = np.array([index for index, _ in kept], int)
        self._order = np.concatenate([texels for _, texels in kept] or [np.empty(0, int)])
        self._sizes = np.array([len(texels) for _, texels in kept], int)
        self._starts = np.cumsum(self._sizes) - self._sizes
        self._count = np.maximum(regions.sum(1) / _PATCH**2, 0.5)
        self._smooth = np.full((len(kept), 3), np.nan)
        self._whole: Array | None = None
        self._time = -np.inf

    @property
    def covariance(self) -> Array:
        """The covariance now, [regions, 3, 3]."""
        whole = np.zeros((3, 3)) if self._whole is None else self._whole
        return np.asarray(whole / self._count[:, None, None])

    def add(self, time: float, ratios: NDArray[np.floating], seen: NDArray[np.bool_]) -> None:
        """Add log ratios of the texels of a frame to the baseline, [texels, 3], where seen."""
        if not len(self._sizes):
            return
        passed = time - self._time if np.isfinite(self._time) else 0.0
        self._time = time
        self._update(self._average(ratios, seen), passed)
        found = self._compare_patches()
        if found is None:
            return
        if self._whole is None:
            self._whole = found
        self._whole = self._whole + (1 - np.exp(-passed / _SECONDS)) * (found - self._whole)

    def _average(self, ratios: NDArray[np.floating], seen: NDArray[np.bool_]) -> Array:
        """Mean of each patch; NaN where less than a half of it is seen."""
        shown = seen[self._order]
        values = np.where(shown[:, None], ratios[self._order], 0.0).astype(np.float64)
        sums = np.add.reduceat(values, self._starts, 0)
        count = np.add.reduceat(shown.astype(np.float64), self._starts)
        means = sums / np.maximum(count, 1)[:, None]
        means[count < self._sizes / 2] = np.nan
        return means

    def _update(self, means: Array, passed: float) -> None:
        share = 1 - np.exp(-passed / _SMOOTH)
        fresh = ~np.isfinite(self._smooth)
        self._smooth = np.where(fresh, means, self._smooth)
        moved = self._smooth + share * (means - self._smooth)
        self._smooth = np.where(np.isfinite(means), moved, self._smooth)

    def _compare_patches(self) -> Array | None:
        """Covariance of patches about the mean of their region, [3, 3]; None with too few."""
        known = np.isfinite(self._smooth).all(1)
        region, values = self._region[known], self._smooth[known]
        count = np.bincount(region, minlength=len(NAMES))
        free = int(np.maximum(count - 1, 0).sum())
        if free < 1:
            return None
        sums = np.stack([np.bincount(region, one, len(NAMES)) for one in values.T], 1)
        apart = values - (sums / np.maximum(count, 1)[:, None])[region]
        return np.asarray(apart.T @ apart / free)
