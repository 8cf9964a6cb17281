"""Skin of a person's hands and arms, which has the pigments of the face without its features."""

import numpy as np
import torch
from jaxtyping import Float

from train.synthetic.scene import (
    CHART_SIZE,
    BeardParameters,
    FaceParameters,
    MarkParameters,
    PigmentParameters,
)
from train.synthetic.tensors import make_float_tensors

_REGIONS = {
    "melanin": ((-0.25, -0.7, 0.0, 0.15, 0.12, -0.1), (0.1, 0.2, 0.08, 0.1, 0.1, 0.05)),
    "hemoglobin": ((0.05, 0.4, 0.3, 0.2, 0.2, 0.1), (0.1, 0.15, 0.15, 0.12, 0.15, 0.1)),
}
"""Means and standard deviations of log factors over the regions of
`train.synthetic.painting.body_painting`."""

_NOISE = {"coarse": (0.1, 8, 10), "middle": (0.07, 24, 30), "fine": (0.06, 84, 104)}
"""Largest standard deviation of an octave, its rows and its columns."""


def sample_body(rng: np.random.Generator, face: FaceParameters) -> FaceParameters:
    """Sample the skin of a person's hands and arms.

    Args:
        rng: Random numbers.
        face: The person's face, without a batch axis.

    Returns:
        Parameters in float32. Base fractions, nuisance and colours are those of the face. `stubble`
        is the opacity of hairs and `grain` is where they grow.
    """
    skin = face.skin
    bump = rng.uniform(0.01, 0.09) * rng.standard_normal((2, *CHART_SIZE), np.float32)
    skin = skin._replace(
        melanin=_sample_pigment(rng, "melanin", skin.melanin),
        hemoglobin=_sample_pigment(rng, "hemoglobin", skin.hemoglobin),
        has_model_skin=torch.tensor(0.0),
        bump=torch.from_numpy(bump),
    )
    hair = face.hair._replace(beard=_sample_beardless(rng))
    return face._replace(skin=skin, marks=_sample_marks(rng), hair=hair)


def _sample_pigment(
    rng: np.random.Generator, name: str, pigment: PigmentParameters
) -> PigmentParameters:
    noise = {
        octave: rng.uniform(0.2, 1) * spread * _sample_noise(rng, *shape)
        for octave, (spread, *shape) in _NOISE.items()
    }
    values = make_float_tensors(
        regions=rng.normal(*_REGIONS[name]), model_skin=np.zeros((1, *CHART_SIZE)), **noise
    )
    return pigment._replace(**values)


def _sample_noise(
    rng: np.random.Generator, rows: int, columns: int
) -> Float[np.ndarray, "1 {rows} {columns}"]:
    """Sample noise that is three times as wide as high, for a chart that is stretched on limbs."""
    return np.asarray(rng.normal(0, 1, (1, rows, columns)).repeat(3, axis=2)[..., 1 : columns + 1])


def _sample_marks(rng: np.random.Generator) -> MarkParameters:
    freckles = rng.random((1, 120, 150)) < rng.choice([0, 0.005, 0.03], p=(0.6, 0.2, 0.2))
    spots = rng.random((1, 60, 74)) < rng.choice([0, 0.004], p=(0.7, 0.3))
    strength = rng.choice([0, rng.uniform(0.1, 0.5)], p=(0.4, 0.6))
    moles = np.column_stack(
        [
            rng.uniform((-1.2, -1.3), (1.2, 1.0), (6, 2)),
            rng.uniform(0.01, 0.03, 6),
            rng.uniform(0.6, 1.6, 6) * (rng.random(6) < 0.35),
        ]
    )
    return MarkParameters(
        **make_float_tensors(
            freckles=rng.uniform(0.2, 0.7) * freckles,
            spots=rng.uniform(0.2, 0.6) * spots,
            vessels=strength * _trace_vessels(rng),
            moles=moles,
        )
    )


def _trace_vessels(rng: np.random.Generator) -> Float[np.ndarray, "1 56 70"]:
    """Lines along the limb: where a smooth field, stretched along it, is near zero."""
    row, column = np.mgrid[:56, :70]
    wave, phase = rng.normal(0, (0.06, 0.2), (5, 2)), rng.uniform(0, 2 * np.pi, 5)
    field = sum(np.sin(a * row + b * column + p) for (a, b), p in zip(wave, phase, strict=True))
    return np.asarray(np.exp(-((field / 0.25) ** 2)))[None]


def _sample_beardless(rng: np.random.Generator) -> BeardParameters:
    return BeardParameters(
        **make_float_tensors(
            beard=0.0,
            moustache=0.0,
            stubble=rng.choice([0.0, rng.uniform(0.05, 0.35)], p=(0.3, 0.7)),
            grain=_draw_hairs(rng),
        )
    )


def _draw_hairs(rng: np.random.Generator) -> Float[np.ndarray, "1 rows columns"]:
    """Short lines along the limb, none of them on fingers."""
    rows, columns = CHART_SIZE
    count = int(1500 * rng.random() ** 2)
    start = rng.uniform((0.42 * rows, 0.15 * columns), (rows, 0.85 * columns), (count, 2))
    along = rng.uniform(1.5, 6, (count, 1)) * rng.normal((1, 0.5), (0.3, 0.5), (count, 2))
    points = start + np.linspace(0, 1, 10)[:, None, None] * along
    row, column = points.round().astype(int).reshape(-1, 2).clip(0, (rows - 1, columns - 1)).T
    hairs = np.zeros((1, rows, columns))
    hairs[0, row, column] = 1
    return hairs
