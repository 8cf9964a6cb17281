"""How bright a texture was recorded: the one factor between its colours and the model's."""

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize_scalar
from scipy.spatial import cKDTree

from skinnet.errors import InputError

_FACTORS = (0.2, 5.0)
"""Range in which the factor is sought."""

_SAMPLE, _MIN_COLOURS = 4000, 100
_DARK = 0.02
"""Colours whose brightest channel is below this share of the brightest colour's are ignored."""


def fit_exposure(
    data: Float[np.ndarray, "n 3"], model: Float[np.ndarray, "m 3"], seed: int = 0
) -> float:
    """Fit the factor that brings recorded colours nearest to the model's.

    One person's scan cannot determine a 3 x 3 transform (section 4.3 requires a sample of all skin
    types), but it determines its brightness, because the hue of skin depends on how dark it is. The
    median distance to the nearest model colour, relative to the colour, is minimised.

    Args:
        data: Linear RGB of skin.
        model: Linear RGB of the model, in any order.
        seed: Seed of the subsample of the data that is used.

    Returns:
        The factor by which `data` are to be multiplied.

    Raises:
        InputError: Fewer than a hundred colours are not black, or the best factor lies at an end
            of its range, 0.2 to 5.

    Example:
        >>> import numpy as np
        >>> pigments = np.random.default_rng(0).uniform(size=(4000, 2))
        >>> depth = pigments @ [[0.4, 0.7, 1.0], [0.1, 0.6, 0.4]]
        >>> model = 0.1 + 0.7 * np.exp(-depth)
        >>> round(fit_exposure(model[:500] / 1.5, model), 2)
        1.5
    """
    brightest = data.max(1)
    usable = data[brightest > _DARK * np.percentile(brightest, 99)] if len(data) else data
    if len(usable) < _MIN_COLOURS:
        raise InputError(
            f"The texture has {len(usable)} colours that are not black; {_MIN_COLOURS} are needed "
            "to fit its exposure."
        )
    rng = np.random.default_rng(seed)
    sample = rng.choice(usable, min(_SAMPLE, len(usable)), replace=False)
    tree = cKDTree(model)

    def measure_distance(log_factor: float) -> float:
        scaled = np.exp(log_factor) * sample
        distance = np.asarray(tree.query(scaled, workers=-1)[0])
        return float(np.median(distance / np.linalg.norm(scaled, axis=1)))

    steps = np.linspace(np.log(_FACTORS[0]), np.log(_FACTORS[1]), 33)
    first = int(np.argmin([measure_distance(log_factor) for log_factor in steps]))
    if first in (0, len(steps) - 1):
        raise InputError(
            f"No exposure between {_FACTORS[0]:g} and {_FACTORS[1]:g} brings the texture near the "
            "colours of skin; give a calibration, or a texture with its colours."
        )
    bounds = (steps[first - 1], steps[first + 1])
    found = minimize_scalar(measure_distance, bounds=bounds, method="bounded")
    return float(np.exp(found.x))
