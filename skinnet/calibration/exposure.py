"""How bright a texture was recorded: the one factor between its colours and the model's."""

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize_scalar
from scipy.spatial import cKDTree

from skinnet.errors import InputError

FACTORS = (0.2, 5.0)
"""Range in which the factor is looked for."""

SAMPLE = 4000
DARK = 0.02
"""Colours whose brightest channel is below this share of the brightest colour's say nothing."""


def exposure(
    data: Float[np.ndarray, "n 3"], model: Float[np.ndarray, "m 3"], seed: int = 0
) -> float:
    """The factor by which `data`, linear RGB, is to be multiplied to lie nearest to `model`.

    A scan of one person cannot fix a 3 x 3 transform (section 4.3 wants a sample of all skin
    types), but its brightness can be told: a colour of skin is dark or pale together with its hue.
    Minimised is the median distance to the nearest model colour, relative to the colour. Raises
    `InputError` where no colour is left to go by, or the best factor lies at an end of `FACTORS`.
    """
    brightest = data.max(1)
    usable = data[brightest > DARK * np.percentile(brightest, 99)] if len(data) else data
    if len(usable) < 100:
        raise InputError(
            f"The texture has {len(usable)} colours that are not black; a hundred are needed to "
            "tell its exposure."
        )
    draw = np.random.default_rng(seed)
    sample = draw.choice(usable, min(SAMPLE, len(usable)), replace=False)
    tree = cKDTree(model)

    def apart(log: float) -> float:
        scaled = np.exp(log) * sample
        distance = np.asarray(tree.query(scaled, workers=-1)[0])
        return float(np.median(distance / np.linalg.norm(scaled, axis=1)))

    steps = np.linspace(np.log(FACTORS[0]), np.log(FACTORS[1]), 33)
    first = int(np.argmin([apart(log) for log in steps]))
    if first in (0, len(steps) - 1):
        raise InputError(
            f"No exposure between {FACTORS[0]:g} and {FACTORS[1]:g} makes skin of the texture; "
            "give a calibration, or a texture with its colours."
        )
    found = minimize_scalar(apart, bounds=(steps[first - 1], steps[first + 1]), method="bounded")
    return float(np.exp(found.x))
