"""Fixed, labelled colour scales of maps: the same in all pictures, so that people can be compared.

The lightness of every colour map (L* of CIELAB) changes evenly and in one direction. The maps can
thus be read in grey, and by people who do not see all colours.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Colours = tuple[tuple[int, int, int], ...]
"""Evenly spaced sRGB colours of a colour map."""

_BROWN: Colours = (
    (254, 249, 234), (239, 213, 155), (223, 176, 91), (205, 138, 47), (180, 102, 31),
    (149, 70, 25), (114, 42, 19), (75, 21, 14), (30, 7, 11),
)  # fmt: skip
_RED: Colours = (
    (252, 248, 251), (248, 205, 222), (248, 159, 181), (243, 111, 133), (227, 61, 79),
    (184, 34, 49), (139, 13, 31), (93, 0, 25), (48, 0, 20),
)  # fmt: skip
_BLUE: Colours = (
    (13, 16, 30), (12, 42, 78), (3, 70, 121), (1, 100, 160), (7, 132, 198), (83, 163, 218),
    (139, 195, 233), (195, 225, 245), (255, 255, 255),
)  # fmt: skip
_GREEN: Colours = (
    (233, 255, 237), (179, 228, 190), (133, 199, 150), (93, 168, 115), (60, 138, 86), (35, 107, 61),
    (21, 76, 41), (16, 47, 26), (11, 19, 12),
)  # fmt: skip
_GREY: Colours = ((0, 0, 0), (255, 255, 255))


class Scale(NamedTuple):
    """A colour scale from 0 to its last tick.

    Attributes:
        measure: What the values are, for the line below the scale.
        colours: The colour map.
        ticks: Numbers that are labelled, the first 0.
        knee: The scale is linear up to this number. Above it equal distances are equal ratios, and
            its slope is continuous. None for a linear scale.
        symbol: The unit, which follows the last number.
        factor: Numbers of the scale for each unit of the map; 100 for fractions in percent.
    """

    measure: str
    colours: Colours
    ticks: tuple[float, ...]
    knee: float | None = None
    symbol: str = "%"
    factor: float = 100.0

    def place(self, values: NDArray[np.floating]) -> NDArray[np.floating]:
        """Place values of a map along the scale; 0 is its begin, 1 its end."""
        numbers, top = values * self.factor, self.ticks[-1]
        if self.knee is None:
            return numbers / top
        ratio = numbers / self.knee
        above = 1 + np.log(np.maximum(ratio, 1))
        end = 1 + np.log(top / self.knee)
        return np.asarray(np.where(ratio < 1, ratio, above) / end)

    def colour(self, values: NDArray[np.floating]) -> NDArray[np.uint8]:
        """Colour values of a map, uint8 sRGB [..., 3]; beyond an end they take its colour."""
        return self.ramp(self.place(values))

    def ramp(self, places: NDArray[np.floating]) -> NDArray[np.uint8]:
        """Colour places along the scale, 0 to 1."""
        stops = np.linspace(0, 1, len(self.colours))
        channels = [np.interp(places, stops, one) for one in zip(*self.colours, strict=True)]
        colours: NDArray[np.uint8] = np.rint(np.stack(channels, -1)).astype(np.uint8)
        return colours

    def label(self) -> list[tuple[str, float]]:
        """List the labels and their places along the scale."""
        names = [f"{tick:g}" for tick in self.ticks]
        names[-1] += f" {self.symbol}"
        places = self.place(np.array(self.ticks) / self.factor)
        return list(zip(names, places.tolist(), strict=True))


# Skin has about 1 to 40 % melanin and 1 to 16 % blood (`SkinPrior`), and a face varies by a factor
# of about two: on these scales pale and dark faces show their pattern with the same contrast.
MELANIN = Scale("melanosomes in the epidermis, by volume", _BROWN, (0, 1, 2, 5, 10, 20, 50), knee=1)
HEMOGLOBIN = Scale("blood in the dermis, by volume", _RED, (0, 1, 2, 5, 10, 20), knee=2)
SHADING = Scale("relative to the light", _GREY, (0, 20, 50, 100, 200), knee=50)
SPECULAR = Scale("relative to the light", _BLUE, (0, 1, 2, 5, 10, 20, 50), knee=1)
MASK = Scale("probability of skin", _GREY, (0, 50, 100))
UNCERTAINTY = Scale(
    "standard deviation as a share of the value", _GREEN, (0, 20, 50, 100, 200), knee=50
)
DISTANCE = Scale("distance", _BLUE[::-1], (0, 1, 2, 3), symbol="mm", factor=1.0)

PIGMENTS = {"melanin": MELANIN, "hemoglobin": HEMOGLOBIN}
