"""The picture of a comparison: both photographs and the changes on one colour scale."""

import math

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._colour_scales import Scale
from skinnet.inference._comparison.changes import Change, to_percent
from skinnet.inference._tiles import draw_grid, draw_map, draw_picture

_BLUE_WHITE_RED = (
    (20, 50, 110), (52, 104, 168), (122, 168, 210), (196, 217, 234), (247, 247, 247),
    (244, 205, 186), (226, 140, 115), (183, 62, 61), (112, 10, 32),
)  # fmt: skip

_FACTORS = (1 / 4, 1 / 2, 1.0, 2.0, 4.0)
"""Factors that are labelled; the scale is linear in their logarithms."""


class ChangeScale(Scale):
    """A scale of log changes, with no change in its middle, which is its lightest colour."""

    def place(self, values: NDArray[np.floating]) -> NDArray[np.floating]:
        """Place log changes along the scale; 0 is its begin, 1 its end."""
        return np.asarray(0.5 + values / (2 * self.ticks[-1]))

    def label(self) -> list[tuple[str, float]]:
        """List the labels, in percent, and their places along the scale."""
        names = [f"{100 * (factor - 1):+.0f}" if factor != 1 else "0" for factor in _FACTORS]
        names[-1] += f" {self.symbol}"
        places = self.place(np.log(_FACTORS))
        return list(zip(names, places.tolist(), strict=True))


CHANGE = ChangeScale(
    "change of the volume fraction",
    _BLUE_WHITE_RED,
    tuple(math.log(factor) for factor in _FACTORS),
    factor=1.0,
)


def draw_comparison(
    before: NDArray[np.uint8],
    after: NDArray[np.uint8],
    changes: dict[str, tuple[NDArray[np.float32], Change]],
) -> NDArray[np.uint8]:
    """Draw both photographs and the maps of changes in one row.

    Args:
        before: The first photograph, uint8 sRGB [h, w, 3].
        after: The second one, warped onto it.
        changes: By pigment, the map of log changes [h, w], NaN where there is none, and the change
            of the face.

    Returns:
        uint8 sRGB.
    """
    tiles = [draw_picture("before", before), draw_picture("after", after)]
    for name, (values, change) in changes.items():
        mask = np.isfinite(values).astype(np.float32)
        # Beyond the ends values have the colour of the end.
        shown = np.nan_to_num(values).clip(CHANGE.ticks[0], CHANGE.ticks[-1])
        tiles.append(draw_map(name, shown, mask, CHANGE, describe_change(change)))
    return draw_grid(tiles, len(tiles))


def describe_change(change: Change) -> str:
    """Describe a change with its interval, in percent."""
    low, high = (to_percent(end) for end in change.interval)
    return f"{change.percent:+.0f} % ({low:+.0f} to {high:+.0f} %)"
