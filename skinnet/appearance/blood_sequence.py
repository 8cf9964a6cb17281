"""Hemoglobin of a face over time, from which a dynamic model is fitted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skinnet.appearance._dynamic_file import FIELD_SIZE, read_model
from skinnet.appearance._track_rows import read_track_rows, spread_regions
from skinnet.errors import InputError
from skinnet.images.faces._face_chart import warp_to_chart

_REST = 0.05
"""Volume fraction at rest of a track, which knows changes alone."""


@dataclass(frozen=True, eq=False)
class BloodSequence:
    """Hemoglobin of a face over time, with what has caused it.

    Attributes:
        rest: Volume fractions at rest on the chart, [size, size]; NaN where there is no skin.
        maps: The same of the frames, [frames, size, size].
        times: In seconds, [frames].
        coefficients: Amount of each cause by its name, [frames] each.

    Example:
        >>> rest = np.full((64, 64), 0.05)
        >>> maps = np.stack([rest, 1.5 * rest])
        >>> BloodSequence(rest, maps, np.arange(2.0), {"flush": np.arange(2.0)}).maps.shape
        (2, 64, 64)
    """

    rest: NDArray[np.floating]
    maps: NDArray[np.floating]
    times: NDArray[np.float64]
    coefficients: Mapping[str, NDArray[np.float64]]

    def __post_init__(self) -> None:
        side, frames = np.shape(self.rest)[:1], np.shape(self.times)
        if np.shape(self.rest) != 2 * side or np.shape(self.maps) != (*frames, *side, *side):
            raise InputError(
                "A sequence has one square map at rest, a map of that size for each time; got "
                f"{np.shape(self.rest)}, {np.shape(self.maps)} and {len(self.times)} times."
            )
        if not np.all(np.diff(self.times) > 0):
            raise InputError("Times of a sequence are seconds that increase.")
        for name, values in self.coefficients.items():
            if np.shape(values) != frames or not np.isfinite(values).all():
                raise InputError(
                    f"{name} needs one finite amount for each of the {frames[0]} times; got an "
                    f"array {np.shape(values)}."
                )

    @classmethod
    def from_pictures(
        cls,
        maps: Sequence[NDArray[np.floating]],
        landmarks: Sequence[NDArray[np.floating]],
        times: NDArray[np.float64],
        coefficients: Mapping[str, NDArray[np.float64]] | None = None,
        size: int = 2 * FIELD_SIZE,
    ) -> "BloodSequence":
        """Lay maps of pictures out on the chart of the shipped model.

        Args:
            maps: Volume fractions of each picture, [h, w]; NaN where there is no skin. The first
                one is the face at rest.
            landmarks: Columns and rows of the face's landmarks in each, as `Face.landmarks`.
            times: In seconds, one for each picture.
            coefficients: Amount of each cause in each picture; None if they are not known.
            size: Side of the chart.

        Returns:
            The sequence, of all pictures.

        Raises:
            InputError: There are no pictures, or their numbers differ.
        """
        if not len(maps) or len(maps) != len(landmarks):
            raise InputError(
                "A sequence has one map or more, each with its landmarks; got "
                f"{len(maps)} and {len(landmarks)}."
            )
        chart = read_model(None)[1]["landmarks"]
        laid_out = np.stack(
            [warp_to_chart(*pair, chart, size) for pair in zip(maps, landmarks, strict=True)]
        )
        return cls(laid_out[0], laid_out, np.asarray(times, np.float64), coefficients or {})

    @classmethod
    def from_track(
        cls,
        table: str | Path,
        coefficients: Mapping[str, NDArray[np.float64]] | None = None,
        size: int = FIELD_SIZE,
    ) -> "BloodSequence":
        """Read the table that `skinnet track` writes: log ratios of regions to the baseline.

        Args:
            table: NAME_track.csv.
            coefficients: Amount of each cause at each row; None if they are not known.
            size: Side of the chart.

        Returns:
            The sequence, with values between the regions; local deviations are not known of it.

        Raises:
            InputError: The table cannot be read, or does not fit the coefficients.
        """
        times, ratios = read_track_rows(Path(table))
        change = spread_regions(ratios, read_model(None)[1]["landmarks"], size)
        rest = np.full((size, size), _REST)
        return cls(rest, rest * np.exp(change), times, coefficients or {})
