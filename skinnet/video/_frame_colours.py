"""Linear colours of a face in a frame, averaged to the size of texels."""

import math

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.video._texture_space import Points, TextureSpace, measure_texel, sample
from skinnet.video._tone_doubt import USUAL

BRIGHTEST, DARKEST = 0.94, 0.0025
"""Linear light beyond which a texel is clipped, or too dark for a logarithm."""

_RAMP = np.arange(256, dtype=np.uint8)


class FrameColours:
    """Samples frames in a texture space, in linear light.

    Args:
        tone: The camera's tone curve, which is undone; None: the usual one.
    """

    def __init__(self, tone: ToneCurve | None = None) -> None:
        self.tone = tone
        # Saturation mixes the channels, so it is undone after sampling, with the rest of the curve.
        self._tone = tone if tone is not None and tone.saturation else None
        ramp = np.repeat(_RAMP[:, None] / 255.0, 3, 1)
        undone = ramp if self._tone is not None else (tone or USUAL).undo(ramp)
        self._table = undone[:, 0].astype(np.float32)

    def __call__(
        self, frame: NDArray[np.uint8], space: TextureSpace, landmarks: Points
    ) -> NDArray[np.float32]:
        """Sample a frame [H, W, 3].

        Returns:
            Linear RGB of the covered texels [texels, 3]; NaN outside of the frame.
        """
        points = space.place(landmarks)
        step = max(1, round(measure_texel(landmarks)))
        left, top, right, bottom = _frame(points, step, frame.shape)
        if right - left < 2 * step or bottom - top < 2 * step:
            return np.full((len(points), 3), np.nan, np.float32)
        small = self._shrink(frame[top:bottom, left:right], step)
        sampled = sample(small, (points - np.array([left, top], np.float32)) / np.float32(step))
        outside = (points < 0).any(1) | (points > (frame.shape[1], frame.shape[0])).any(1)
        sampled[outside] = np.nan
        if self._tone is not None:
            sampled = self._tone.undo(sampled.astype(np.float64)).astype(np.float32)
        return sampled

    def _shrink(self, part: NDArray[np.uint8], step: int) -> NDArray[np.float32]:
        """Average linear light over squares of pixels: all pixels count, which lowers the noise."""
        height, width = (side // step * step for side in part.shape[:2])
        linear = self._table.take(part[:height, :width])
        if step == 1:
            return linear
        rows = linear.reshape(height // step, step, width * 3).mean(1)
        small: NDArray[np.float32] = rows.reshape(height // step, width // step, step, 3).mean(2)
        return small


def _frame(
    points: NDArray[np.float32], step: int, shape: tuple[int, ...]
) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of the pixels around points, within the frame."""
    low, high = points.min(0) - 2 * step, points.max(0) + 2 * step
    left, top = (max(0, math.floor(each)) for each in low)
    right, bottom = min(shape[1], math.ceil(high[0])), min(shape[0], math.ceil(high[1]))
    return left, top, right, bottom
