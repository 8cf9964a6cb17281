"""The tone curve of a camera that is not known: its usual bend, and what the doubt of it does."""

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._references.tone_curve import ToneCurve

USUAL = ToneCurve(bend=0.12)
"""The mean of the cameras that the network is trained with: most lift contrast by an S-curve."""

_BEND_SD, _KNOWN_SD = 0.15, 0.03
"""Standard deviation of the bend over the training's cameras, and of one that was measured."""

_STEP = 0.02
_RAMP = np.repeat(np.arange(1, 256)[:, None] / 255.0, 3, 1)
_LEAST = 1e-6

Array = NDArray[np.float64]


class ToneDoubt:
    """What an error of the tone curve's bend does to ratios of colours.

    Where the exposure or the shading changes, a bent curve moves bright and dark channels by
    different factors, which looks like a change of blood.

    Args:
        tone: The curve that is undone; None: the usual one, which is not known well.
    """

    def __init__(self, tone: ToneCurve | None = None) -> None:
        given = USUAL if tone is None else tone
        self._sd = _BEND_SD if tone is None else _KNOWN_SD
        more, less = (
            np.log(np.maximum(given._replace(bend=given.bend + way * _STEP).undo(_RAMP), _LEAST))
            for way in (1, -1)
        )
        self._levels: Array = np.log(np.maximum(given.undo(_RAMP)[:, 0], _LEAST))
        self._answer: Array = ((more - less) / (2 * _STEP))[:, 0]

    def find_covariance(self, base: Array, gains: Array) -> Array:
        """Covariance of log ratios to a baseline by the doubt of the curve, [regions, 3, 3].

        Args:
            base: Linear RGB of the regions in the baseline, [regions, 3].
            gains: Log gain of exposure and shading since then, [regions].
        """
        level = np.log(np.maximum(base, _LEAST))
        moved = self._find_answer(level + gains[:, None]) - self._find_answer(level)
        return np.asarray(self._sd**2 * moved[:, :, None] * moved[:, None, :])

    def _find_answer(self, level: Array) -> Array:
        """Derivative of a log level by the bend."""
        return np.asarray(np.interp(level, self._levels, self._answer))
