"""Colour, typology angle, instrument indices and nearest tone of skin with given pigments."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._arguments import check_number
from skinnet.inference._index_definitions import find_typology_group
from skinnet.inference._index_summary import Index, NearestTone, SkinIndices
from skinnet.inference._index_table import INDICES, OPTICS, look_up
from skinnet.inference._skin_tones import compare_with_monk
from skinnet.inference._uncertainty import LEVEL, find_factor

_GRID = np.linspace(-1, 1, 5)
"""Places between both ends of a pigment's interval: not every index rises, or falls, throughout."""


class _Spread(NamedTuple):
    """Indices [6] of what is read, how far they may lie below and above, and colours [n, 3]."""

    values: NDArray[np.float64]
    below: NDArray[np.float64]
    above: NDArray[np.float64]
    colours: NDArray[np.float64]


def compute_indices(
    melanin: float,
    hemoglobin: float,
    log_sds: tuple[float, float] = (0.0, 0.0),
    level: float = LEVEL,
) -> SkinIndices:
    """Compute the numbers that people use for skin, from its pigments.

    An interval has two parts, which are added as independent. The first is the range of the index
    over all pairs of fractions in the intervals of both pigments. How the errors of both pigments
    are correlated is not known; this is the widest range that any correlation gives, and it needs
    no linear model. The second is how far people with the same pigments differ: in thickness,
    scattering and oxygenation of the skin, and in what the model leaves over.

    Args:
        melanin: Volume fraction of melanosomes in [0, 1], for the preset `measured`. The table ends
            at .006 and .43; beyond them the indices are those of its ends.
        hemoglobin: Volume fraction of blood in [0, 1]. The table ends at .006 and .15.
        log_sds: Standard deviations of the natural logarithms of both, at least 0.
        level: Probability that a true number lies in its interval, between 0 and 1.

    Returns:
        L*a*b* and typology angle under D65, melanin index, erythema index, and the nearest tone of
        the Monk Skin Tone Scale.

    Raises:
        InputError: A fraction, a standard deviation or the level is out of its range.

    Source:
        Typology angle: Chardon et al. 1991. Melanin and erythema index: Diffey et al. 1984;
        Takiwaki et al. 1994; Shriver & Parra 2000. Scale: Monk 2019, https://skintone.google.

    Example:
        >>> from skinnet.inference import compute_indices
        >>> found = compute_indices(0.05, 0.04, log_sds=(0.15, 0.1))
        >>> round(found.typology_angle.value), found.typology_group, found.monk_tone.value
        (56, 'very_light', 5)
    """
    _check(melanin, hemoglobin, log_sds)
    wide = _spread(melanin, hemoglobin, log_sds, level)
    one_sd = _spread(melanin, hemoglobin, log_sds, math.erf(math.sqrt(0.5)))
    sds = (one_sd.below + one_sd.above) / 2
    rows = np.stack([wide.values, sds, wide.values - wide.below, wide.values + wide.above], -1)
    indices = {
        name: Index(value, sd, (low, high))
        for name, (value, sd, low, high) in zip(INDICES, rows.tolist(), strict=True)
    }
    group = find_typology_group(indices["typology_angle"].value)
    return SkinIndices(**indices, typology_group=group, monk_tone=_find_monk_tone(wide))


def _find_indices(
    optics: str | None,
    means: tuple[float | None, float | None],
    log_sds: tuple[float, float],
    level: float = LEVEL,
) -> SkinIndices | None:
    """Compute the indices of mean pigments; None where there are none, or for another preset."""
    melanin, hemoglobin = means
    if optics != OPTICS or melanin is None or hemoglobin is None:
        return None
    return compute_indices(melanin, hemoglobin, log_sds, level)


def _check(melanin: float, hemoglobin: float, log_sds: tuple[float, float]) -> None:
    for name, fraction in (("melanin", melanin), ("hemoglobin", hemoglobin)):
        fraction = check_number(name, fraction)
        if not 0 <= fraction <= 1:
            raise InputError(
                f"{name} is a volume fraction in [0, 1]; got {fraction:g}. Was it given in percent?"
            )
    if not isinstance(log_sds, Sequence) or isinstance(log_sds, str) or len(log_sds) != 2:
        raise InputError(f"log_sds are those of melanin and hemoglobin; got {log_sds!r:.60}.")
    for sd in log_sds:
        sd = check_number("A standard deviation in log_sds", sd)
        if not 0 <= sd < math.inf:
            raise InputError(
                f"log_sds are standard deviations of natural logarithms, at least 0; got {sd:g}."
            )


def _spread(
    melanin: float, hemoglobin: float, log_sds: tuple[float, float], level: float
) -> _Spread:
    factors = np.array([find_factor(sd, level) for sd in log_sds])
    down, across = np.meshgrid(*(factor**_GRID for factor in factors), indexing="ij")
    values, sds = look_up(melanin * down.ravel(), hemoglobin * across.ravel())
    middle = len(values) // 2
    people = math.log(find_factor(1.0, level)) * sds[middle]
    return _Spread(
        values[middle],
        np.hypot(values[middle] - values.min(0), people),
        np.hypot(values.max(0) - values[middle], people),
        values[:, :3],
    )


def _find_monk_tone(spread: _Spread) -> NearestTone:
    """The nearest tone, and those of the colours in the pigments' intervals and of the L* ends."""
    middle = spread.values[:3]
    ends = np.stack([middle, middle])
    ends[:, 0] += -spread.below[0], spread.above[0]
    differences = compare_with_monk(np.concatenate([middle[None], spread.colours, ends]))
    tones = differences.argmin(-1) + 1
    interval = int(tones.min()), int(tones.max())
    return NearestTone(int(tones[0]), interval, float(differences[0].min()))
