"""How uncertain the size of a change of blood is."""

import numpy as np
from numpy.typing import NDArray

from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.video._blood_response import BloodResponse
from skinnet.video._resting_maps import RestingMaps

_SCALE_SD, _SCALE_BY_TONE, _MOST_SCALE_SD = 0.22, (0.10, 0.30), 0.45
"""Relative standard deviation of a change for a melanin of .1, by how much it grows with the
logarithm of less and of more melanin, and its most. Skins differ in what else they are made of (see
`_blood_response._ANSWER`), tone curves scale colours, and melanin hides blood. It is that of the
slopes of read over true changes in 28 synthetic clips, which are not those of the benchmark. What
the uncertainty of the resting maps adds is computed."""

Array = NDArray[np.float64]


def find_scale_sd(
    table: ColourTable,
    rest: RestingMaps,
    regions: NDArray[np.bool_],
    melanin: tuple[Array, Array],
    blood: tuple[Array, Array],
) -> Array:
    """Find the relative standard deviation of changes, [regions].

    Where more blood is read than there is, the model's colours answer more to a change of its
    logarithm, and the change that is read is too small.

    Args:
        table: The model's colours.
        rest: The face at rest.
        regions: Texels of each region, bool [regions, texels].
        melanin: Mean of the regions at rest, and standard deviation of its logarithm, [regions].
        blood: The same of hemoglobin.
    """
    darkness = np.log(np.maximum(melanin[0], 1e-3) / 0.1)
    by_tone = np.where(darkness < 0, -_SCALE_BY_TONE[0], _SCALE_BY_TONE[1]) * darkness
    own = np.minimum(_SCALE_SD + by_tone, _MOST_SCALE_SD)
    variance = own**2
    for pigment, (_, sds) in enumerate((melanin, blood)):
        slopes = []
        for way in (-1, 1):
            factors = np.ones((len(regions), 2), np.float32)
            factors[:, pigment] = np.exp(way * sds)
            slopes.append(BloodResponse(table, rest, regions, factors).measure_chroma())
        variance += (np.log(slopes[1] / slopes[0]) / 2) ** 2
    return np.asarray(np.sqrt(variance))
