"""The map of a change of blood over the face."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.video._baseline import Baseline, ComparedFrame
from skinnet.video._resting_maps import RestingMaps
from skinnet.video._texture_space import TextureSpace

_BLUR = 2.5
"""Standard deviation, in texels, over which the map is smoothed."""

_LEAST_SEEN = 0.2
"""Least part of a texel's surroundings that is seen."""

_NOISE_SD, _GLOSS_SD, _LIGHT_SD = 0.012, 0.006, 2.0
"""Standard deviations of log colours, of gloss in shares of green light, and of the logarithm of
the light on a texel."""

_STEP = 0.1
"""Half of the step of log hemoglobin over which the model's colours are compared."""

_LEAST_COLOUR = 1e-4


class ChangeMap:
    """Maps the log change of hemoglobin of each texel, in which gain and gloss hardly count.

    Args:
        table: The model's colours.
        rest: The face at rest.
        baseline: Its colours.
        space: Where the texels lie.
    """

    def __init__(
        self, table: ColourTable, rest: RestingMaps, baseline: Baseline, space: TextureSpace
    ) -> None:
        self._usable, self._space = baseline.usable, space
        self._weights = _weigh_channels(table, rest, baseline.colours)

    def __call__(self, compared: ComparedFrame, gain: float) -> NDArray[np.float32]:
        """Log change over the texture, [size, size], less the log gain; NaN where no skin is."""
        chosen = compared.seen & self._usable
        with np.errstate(invalid="ignore"):
            ratio = compared.texels - np.float32(gain)
        values = np.where(chosen, (ratio * self._weights).sum(1), 0)
        layers = self._space.fill(np.stack([values, chosen], -1).astype(np.float32), 0.0)
        smooth = ndimage.gaussian_filter(layers, (_BLUR, _BLUR, 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            texture = smooth[..., 0] / smooth[..., 1]
        usable = self._space.fill(self._usable.astype(np.float32), 0.0) > 0
        texture[~usable | (smooth[..., 1] < _LEAST_SEEN)] = np.nan
        return np.asarray(texture, np.float32)


def _weigh_channels(
    table: ColourTable, rest: RestingMaps, base: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Weights of log R, G, B in the change of each texel, [texels, 3]."""
    lit = [
        np.log(
            np.maximum(
                table(rest.melanin, rest.hemoglobin * np.exp(way * np.float32(_STEP))),
                _LEAST_COLOUR,
            )
            + rest.gloss[:, None]
        )
        for way in (-1, 1)
    ]
    slope = ((lit[1] - lit[0]) / (2 * np.float32(_STEP))).astype(np.float64)
    white = base[:, 1:2] / np.maximum(base, _LEAST_COLOUR) * _GLOSS_SD
    noise = _NOISE_SD**2 * np.eye(3) + _LIGHT_SD**2
    total = noise + white[:, :, None] * white[:, None, :]
    weights = np.linalg.solve(total, slope[..., None])[..., 0]
    information = np.maximum((weights * slope).sum(1), 1e-9)
    return np.asarray(weights / information[:, None], np.float32)
