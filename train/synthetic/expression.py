"""Mild expressions as weights of ICT-FaceKit's shapes."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

MOODS = (
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


def expression(
    names: Sequence[str], gaze: Float[np.ndarray, "2"], draw: np.random.Generator
) -> Float[np.ndarray, "shapes"]:
    """Weights of the shapes `names`: no mood, one or two, lids that follow the gaze, a blink."""
    strength: dict[str, float] = {}
    for mood in draw.choice(len(MOODS), draw.choice(3, p=(0.3, 0.5, 0.2)), replace=False):
        force = draw.uniform(0.3, 1.2)
        for name, weight in MOODS[mood].items():
            strength[name] = max(strength.get(name, 0.0), force * weight)
    strength["eyeBlink"] = draw.uniform(0, 0.25) if draw.random() < 0.9 else draw.uniform(0.25, 1.0)
    strength["eyeLookDown"], strength["eyeLookUp"] = max(0, -gaze[1]) / 0.5, max(0, gaze[1]) / 0.5
    weights = np.array([strength.get(name.removesuffix("_L").removesuffix("_R"), 0.0)
                        for name in names])  # fmt: skip
    # Both halves of a face seldom move alike.
    return (weights * draw.uniform(0.85, 1.15, len(names))).clip(0, 1)
