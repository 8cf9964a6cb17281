"""Colours and instrument readings of skin with given pigments, from the table in the package."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.inference._index_definitions import compute_typology_angle
from skinnet.inference._skin_tones import read_rows

OPTICS = "measured"
"""Preset of the skin's constants to which the table's fractions belong."""

TABLE = "skin_indices"

MEASURES = ("l_star", "a_star", "b_star", "melanin_index", "erythema_index")
"""What the table holds at each pair of fractions."""

INDICES = ("l_star", "a_star", "b_star", "typology_angle", "melanin_index", "erythema_index")
"""What is read from it; the angle is that of the colour between nodes."""

COLUMNS = ("melanin", "hemoglobin", *MEASURES, *(f"{name}_sd" for name in INDICES))
"""Columns of the table; the last ones are how far people with these pigments differ."""


class _Table(NamedTuple):
    """Values [measure, melanin, hemoglobin] at nodes evenly spaced in the fractions' logarithms.

    Attributes:
        values: `MEASURES`, then standard deviations of `INDICES`.
        low: Logarithms of the least fractions of melanin and hemoglobin.
        step: Distance of nodes.
    """

    values: NDArray[np.float64]
    low: NDArray[np.float64]
    step: NDArray[np.float64]


def look_up(
    melanin: NDArray[np.float64], hemoglobin: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Look up indices of skin with given pigments, and how far people with them differ.

    Fractions beyond the table are those of its border.

    Args:
        melanin: Volume fractions [*shape].
        hemoglobin: Volume fractions [*shape].

    Returns:
        `INDICES` and their standard deviations, both [*shape, 6].
    """
    table = _read()
    with np.errstate(divide="ignore"):
        logs = np.log(np.stack([melanin, hemoglobin]))
    shape = (2,) + (1,) * (logs.ndim - 1)
    # The border first: an infinite place has no neighbours.
    place = np.maximum((logs - table.low.reshape(shape)) / table.step.reshape(shape), 0.0)
    found = np.stack(
        [ndimage.map_coordinates(one, place, order=1, mode="nearest") for one in table.values], -1
    )
    lab, rest, sd = found[..., :3], found[..., 3:5], found[..., 5:]
    return np.concatenate([lab, compute_typology_angle(lab)[..., None], rest], -1), sd


@cache
def _read() -> _Table:
    rows = np.array(read_rows(TABLE), np.float64)
    axes = [np.unique(np.log(rows[:, column])) for column in (0, 1)]
    values = rows[:, 2:].T.reshape(-1, *(len(axis) for axis in axes))
    low = np.array([axis[0] for axis in axes])
    step = np.array([(axis[-1] - axis[0]) / (len(axis) - 1) for axis in axes])
    return _Table(values, low, step)
