"""Expressions, as weights of ICT-FaceKit's shapes."""

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


_OPEN_MOODS = (
    {"mouthSmile": 0.9, "mouthUpperUp": 0.55, "mouthLowerDown": 0.35, "jawOpen": 0.1,
     "cheekSquint": 0.6, "eyeSquint": 0.2},
    {"mouthSmile": 0.8, "mouthUpperUp": 0.4, "mouthLowerDown": 0.5, "jawOpen": 0.3,
     "cheekSquint": 0.7, "eyeSquint": 0.35},
    {"mouthStretch": 0.5, "mouthUpperUp": 0.5, "mouthLowerDown": 0.6, "jawOpen": 0.08},
    {"jawOpen": 0.35, "mouthUpperUp": 0.2, "mouthLowerDown": 0.3},
    {"jawOpen": 0.6, "mouthFunnel": 0.35, "browInnerUp": 0.6, "eyeWide": 0.5},
)  # fmt: skip
"""Smile and laugh with teeth, grimace, speech and surprise."""

_OPEN_SHARES = (0.4, 0.25, 0.1, 0.17, 0.08)

OPEN_MOUTH_SHARE = 1 / 3
"""Share of the faces of the variety `any` whose mouths are open."""


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
    return _move_face(_mix_moods(_MOODS, rng), names, gaze, rng)


def sample_any_expression(
    names: Sequence[str], gaze: Float[np.ndarray, "2"], rng: np.random.Generator
) -> Float[np.ndarray, "shapes"]:
    """Sample an expression: one third with an open mouth, most of these smiles that show teeth.

    Arguments and result are those of `sample_expression`.
    """
    if rng.random() < OPEN_MOUTH_SHARE:
        mood, force = rng.choice(len(_OPEN_MOODS), p=_OPEN_SHARES), rng.uniform(0.7, 1.15)
        strength = {name: force * weight for name, weight in _OPEN_MOODS[mood].items()}
    else:
        strength = _mix_moods([mood for mood in _MOODS if "jawOpen" not in mood], rng)
    return _move_face(strength, names, gaze, rng)


def _mix_moods(moods: Sequence[dict[str, float]], rng: np.random.Generator) -> dict[str, float]:
    """Mix none, one or two of them."""
    strength: dict[str, float] = {}
    for mood in rng.choice(len(moods), rng.choice(3, p=(0.3, 0.5, 0.2)), replace=False):
        force = rng.uniform(0.3, 1.2)
        for name, weight in moods[mood].items():
            strength[name] = max(strength.get(name, 0.0), force * weight)
    return strength


def _move_face(
    strength: dict[str, float],
    names: Sequence[str],
    gaze: Float[np.ndarray, "2"],
    rng: np.random.Generator,
) -> Float[np.ndarray, "shapes"]:
    """Add eyelids that follow the gaze, and a blink."""
    strength["eyeBlink"] = rng.uniform(0, 0.25) if rng.random() < 0.9 else rng.uniform(0.25, 1.0)
    strength["eyeLookDown"], strength["eyeLookUp"] = max(0, -gaze[1]) / 0.5, max(0, gaze[1]) / 0.5
    weights = np.array([strength.get(name.removesuffix("_L").removesuffix("_R"), 0.0)
                        for name in names])  # fmt: skip
    # Both halves of a face seldom move alike.
    return (weights * rng.uniform(0.85, 1.15, len(names))).clip(0, 1)
