"""How a head moves in a synthetic video: rigidly, and with expression-like bending."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

MotionKind = Literal["still", "moving", "talking"]
KINDS: tuple[MotionKind, ...] = ("still", "moving", "talking")

_SIZES = {  # shift and scale in widths of the picture, and angles in degrees
    "still": (0.0015, 0.001, 0.15),
    "moving": (0.025, 0.02, 5.0),
    "talking": (0.010, 0.008, 2.5),
}

Wave = Float[np.ndarray, "waves 3"]


@dataclass(frozen=True)
class HeadMotion:
    """Smooth random movement: each degree of freedom is a sum of three slow waves.

    Attributes:
        kind: Still but for a sway, moving and turning, or talking and smiling.
        waves: Amplitude (relative), frequency in Hz and phase of the waves of each of shift right
            and down, scale, roll, yaw and pitch, [6, 3, 3].
        exposure: The same of the log exposure, [3, 3].
        speech: The same of the opening of the mouth, the smile and the brows, [3, 3, 3].
    """

    kind: MotionKind
    waves: Float[np.ndarray, "6 3 3"]
    exposure: Wave
    speech: Float[np.ndarray, "3 3 3"]

    def pose(self, time: float) -> Float[np.ndarray, "6"]:
        """Shift right and down, log scale, and roll, yaw and pitch in radians."""
        shift, scale, degrees = _SIZES[self.kind]
        sizes = np.array([shift, shift, scale, *[np.radians(degrees)] * 3])
        return np.asarray(sizes * (_evaluate(self.waves, time) - _evaluate(self.waves, 0.0)))

    def gain(self, time: float) -> float:
        """Log exposure relative to the first frame."""
        return 0.12 * float(_evaluate(self.exposure, time) - _evaluate(self.exposure, 0.0))

    def expression(self, time: float) -> Float[np.ndarray, "3"]:
        """Opening of the mouth, smile and lift of the brows, about in [0, 1]; 0 unless talking."""
        if self.kind != "talking":
            return np.zeros(3)
        rise = np.clip(time / 1.0, 0, 1)
        return np.asarray(rise * np.abs(_evaluate(self.speech, time)).clip(0, 1))


def sample_motion(rng: np.random.Generator, kind: MotionKind) -> HeadMotion:
    """Sample the movement of a clip."""
    slow = _sample_waves(rng, 6, (0.08, 0.6))
    speech = _sample_waves(rng, 3, (0.2, 2.5))
    speech[1:, :, 1] *= 0.2  # smiles and brows are slower than speech
    return HeadMotion(kind, slow, _sample_waves(rng, 1, (0.02, 0.15))[0], speech)


def displace(
    points: Float[np.ndarray, "h w 2"],
    expression: Float[np.ndarray, "3"],
    mouth: Float[np.ndarray, "4 2"],
    face: float,
) -> Float[np.ndarray, "h w 2"]:
    """Where points of a picture with an expression lie in the picture of the face at rest.

    Args:
        points: Columns and rows.
        expression: Opening, smile and lift of the brows.
        mouth: Right and left corner of the mouth, its middle, and the middle of the brows.
        face: Side of the face's box.
    """
    opening, smile, lift = expression
    corners = [(mouth[0], (-1.0, -0.5)), (mouth[1], (1.0, -0.5))]
    moved = np.zeros_like(points)
    for corner, way in corners:
        moved += 0.05 * smile * face * _bump(points, corner, 0.14 * face)[..., None] * way
    below = 1 / (1 + np.exp(-(points[..., 1] - mouth[2, 1]) / (0.02 * face)))
    jaw = below * _bump(points, mouth[2] + (0, 0.12 * face), 0.3 * face)
    moved[..., 1] += 0.07 * opening * face * jaw
    moved[..., 1] -= 0.04 * lift * face * _bump(points, mouth[3], 0.25 * face)
    return np.asarray(points - moved)


def _bump(
    points: Float[np.ndarray, "h w 2"], centre: Float[np.ndarray, "2"], size: float
) -> Float[np.ndarray, "h w"]:
    return np.asarray(np.exp(-((points - centre) ** 2).sum(-1) / (2 * size**2)))


def _sample_waves(
    rng: np.random.Generator, count: int, band: tuple[float, float]
) -> Float[np.ndarray, "count 3 3"]:
    amplitude = rng.dirichlet(np.ones(3), count)
    low, high = np.log(band).tolist()
    frequency = np.exp(rng.uniform(low, high, (count, 3)))
    return np.stack([amplitude, frequency, rng.uniform(0, 2 * np.pi, (count, 3))], -1)


def _evaluate(waves: Float[np.ndarray, "... 3 3"], time: float) -> Float[np.ndarray, "..."]:
    amplitude, frequency, phase = np.moveaxis(waves, -1, 0)
    return np.asarray((amplitude * np.sin(2 * np.pi * frequency * time + phase)).sum(-1))
