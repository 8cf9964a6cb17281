"""Long beards that hang from cheeks and chin."""

import numpy as np

from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.bodies.shell import HeadSurface, make_sheet, move_out, sample_waves, stretch
from train.synthetic.labels import BEARD

_FACE_ROWS, _HANGING_ROWS, _COLUMNS = 40, 36, 91


def make_long_beard(surface: HeadSurface, rng: np.random.Generator) -> LabelledMesh:
    """Make a beard as thick as cloth at its edge, with strands and ragged ends.

    Args:
        surface: The head's skin.
        rng: Random numbers.

    Returns:
        The beard. Moustache and edges are painted on the skin around it.
    """
    across, down = np.meshgrid(np.linspace(-1, 1, _COLUMNS), np.linspace(0, 1, _FACE_ROWS))
    side = np.abs(1.22 * across)
    # The upper edge runs under the lower lip, around the mouth and along the cheek.
    top = np.where(side < 0.3, -0.81 + 0.12 * (side / 0.3) ** 4, -0.69 + 0.5 * (side - 0.3))
    top = top + 0.012 * sample_waves(rng, across, 0 * down, (25.0, 1.0))
    bottom = -1.14 + 0.2 * np.abs(across) ** 2
    points = surface.place(1.22 * across, top + (np.minimum(bottom, top - 0.05) - top) * down)
    thick = rng.uniform(0.05, 0.12) * (1 - np.exp(-down / 0.2)) * (1 - across**4)
    points = move_out(stretch(points, 0.004, 40), thick)
    hanging = _hang(points[-1], across[0], rng)
    points = np.concatenate([points, hanging])
    rows = np.linspace(-1, 1, len(points))[:, None]
    strands = sample_waves(rng, across[:1] + 0 * rows, rows, (28.0, 2.5))
    depth = ((rows + 1) / 2 / 0.3).clip(0, 1)
    points = move_out(points, 0.012 * strands * depth)
    return make_sheet(points, BEARD, 2 * across[:1], rows)


def _hang(chin: np.ndarray, across: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Continue the lowest row downwards, narrower and with ragged ends."""
    share = np.linspace(0, 1, _HANGING_ROWS + 1)[1:, None]
    ragged = sample_waves(rng, across[None], 0 * share, (18.0, 1.0))
    length = rng.uniform(0.12, 0.75) * (1 - 0.75 * across**2) * (1 + 0.12 * ragged)
    x = chin[:, 0] * (1 - rng.uniform(0.1, 0.6) * share**1.3)
    y = chin[:, 1] - length * share
    z = chin[:, 2] - rng.uniform(-0.05, 0.2) * share**2
    return np.stack([x, y, z], -1)
