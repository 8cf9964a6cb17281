"""Glasses, and sunglasses with their lenses."""

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.labelled_mesh import LabelledMesh, join
from train.synthetic.bodies.shell import make_sheet
from train.synthetic.garments.frames import Frame, make_frame, place_rim
from train.synthetic.labels import CLEAR_LENS, LENS

SUNGLASSES_SHARE = 0.35

_RADII = ((0.003, 0.005), (0.008, 0.02), (0.024, 0.045))
"""Of the wires of rimless glasses, of thin frames and of thick ones."""


def make_glasses(
    skin: LabelledMesh, eyes: Float[np.ndarray, "2 3"], rng: np.random.Generator
) -> LabelledMesh:
    """Make glasses of the variety `mild`: two rims, the bridge and the temples.

    Args:
        skin: The head's skin.
        eyes: The foremost points of both eyes.
        rng: Random numbers.

    Returns:
        The frame.
    """
    half_axes = rng.uniform(0.2, 0.26), rng.uniform(0.13, 0.2)
    frame = Frame(*half_axes, rng.uniform(2.0, 4.0), rng.uniform(0.008, 0.024))
    return make_frame(skin, place_rim(skin, eyes, frame), frame)


def make_any_glasses(
    skin: LabelledMesh, eyes: Float[np.ndarray, "2 3"], rng: np.random.Generator
) -> LabelledMesh:
    """Make glasses of the variety `any`: 20 % rimless, 50 % thin, 30 % thick; 35 % are sunglasses.

    Args:
        skin: The head's skin.
        eyes: The foremost points of both eyes.
        rng: Random numbers.

    Returns:
        The frame and its lenses, dark or clear.
    """
    radius = rng.uniform(*_RADII[rng.choice(3, p=(0.2, 0.5, 0.3))])
    dark = rng.random() < SUNGLASSES_SHARE
    height = rng.uniform(0.16, 0.27) if dark else rng.uniform(0.11, 0.22)
    frame = Frame(rng.uniform(0.2, 0.3), height, rng.uniform(1.9, 4.5), radius)
    rim = place_rim(skin, eyes, frame)
    parts = [make_frame(skin, rim, frame)]
    label = LENS if dark else CLEAR_LENS
    parts += [_make_lens(rim * side, label) for side in ([1, 1, 1], [-1, 1, 1])]
    return join(parts)


def _make_lens(rim: Float[np.ndarray, "points 3"], label: int) -> LabelledMesh:
    """Fill a rim with a lens that bulges a little; its chart is 1 at the rim."""
    share = np.linspace(0, 1, 9)[:, None]
    middle = (rim.min(0) + rim.max(0)) / 2
    points = middle + share[..., None] * (rim - middle)
    points[..., 2] += 0.035 * (1 - share**2)
    half = (rim.max(0) - rim.min(0))[:2] / 2
    x, y = np.moveaxis((points - middle)[..., :2] / half, -1, 0)
    return make_sheet(points, label, x, y)
