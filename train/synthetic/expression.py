"""Mild expressions, as weights of ICT-FaceKit's shapes."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

_MOODS = (
    {"mouthSmile": 0.7, "cheekSquint": 0.4, "eyeSquint": 0.2},
    {"mouthSmile": 0.8, "jawOpen": 0.12, "mouthUpperUp": 0.3, "mouthLowerDown": 0.3,
     "cheekSquint": 0.5},
    {"jawOpen": 0.35, "mouthFunnel": 0.15},
    {"mouthFrown": 0.5, "browDown": 0.4},
    {"browInnerUp": 0.6, "browOuterUp": 0.5, "eyeWide": 0.3},
    {"browDown": 0.6, "eyeSquint": 0.4},
    {"mouthPress": 0.5, "mouthRollLower": 0.25, "mouthRollUpper": 0.25},
    {"mouthPucker": 0.4},
)  # fmt: skip


def sample_expression(
    names: Sequence[str], gaze: Float[np.ndarray, "2"], rng: np.random.Generator
) -> Float[np.ndarray, "shapes"]:
    """Sample a mild expression: no mood, one or two, eyelids that follow the gaze, and a blink.

    Args:
        names: Names of ICT-FaceKit's shapes.
        gaze: Radians to the left and up.
        rng: Random numbers.

    Returns:
        A weight in [0, 1] for each shape.
    """
    strength: dict[str, float] = {}
    for mood in rng.choice(len(_MOODS), rng.choice(3, p=(0.3, 0.5, 0.2)), replace=False):
        force = rng.uniform(0.3, 1.2)
        for name, weight in _MOODS[mood].items():
            strength[name] = max(strength.get(name, 0.0), force * weight)
    strength["eyeBlink"] = rng.uniform(0, 0.25) if rng.random() < 0.9 else rng.uniform(0.25, 1.0)
    strength["eyeLookDown"], strength["eyeLookUp"] = max(0, -gaze[1]) / 0.5, max(0, gaze[1]) / 0.5
    weights = np.array([strength.get(name.removesuffix("_L").removesuffix("_R"), 0.0)
                        for name in names])  # fmt: skip
    # Both halves of a face seldom move alike.
    return (weights * rng.uniform(0.85, 1.15, len(names))).clip(0, 1)
