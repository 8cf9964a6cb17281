"""The shape model that needs no file: the procedural face as a mesh with modes."""

from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.shape._ibug import IBUG
from skinnet.shape.model import ShapeModel

FACE_OUTLINE = (1.25, 0.975, -0.175, 2.5)
"""Outline of the face on the chart, a superellipse: half its width, half its height and the
elevation of its centre in radians, and its exponent. It excludes ears, hair and throat."""

HEIGHT = 180.0
"""Height of the mean face in millimetres."""

SAMPLES = 400
"""Sampled faces from which the modes are computed, in pairs with opposite identity numbers."""

MODES = 43
"""Modes that are kept, one for each identity number; they hold 99.99 % of the variance."""

# Azimuth and elevation in radians of the features of the mean head.
_LANDMARK_ANGLES = {
    "left_brow_outer": (0.57, 0.15),
    "left_brow_inner": (0.12, 0.17),
    "nose_bridge": (0.0, 0.03),
    "nose_tip": (0.0, -0.32),
    "left_nostril": (0.14, -0.43),
    "nose_base": (0.0, -0.48),
    "left_eye_outer": (0.45, 0.01),
    "left_eye_inner": (0.2, 0.0),
    "mouth_left": (0.30, -0.66),
    "mouth_top": (0.0, -0.55),
    "mouth_bottom": (0.0, -0.775),
    "lips_upper": (0.0, -0.635),
    "lips_lower": (0.0, -0.685),
    "chin": (0.0, -1.03),
}


@cache
def build_default_model() -> ShapeModel:
    """Build the procedural face with some 6,000 vertices, once."""
    return build_procedural_model()


def build_procedural_model(rows: int = 115, columns: int = 153) -> ShapeModel:
    """Build the procedural face on a grid over its chart, a third of which the face covers.

    The modes are principal components of `SAMPLES` faces with seeded standard normal numbers.
    Vertices, triangles and modes are their own mirror images under x -> -x. The texture space is
    the chart. Needs torch. Raises `InputError` for an even number of columns, which has no column
    in the middle, or a grid too coarse for the features.
    """
    if columns % 2 == 0 or min(rows, columns) < 31:
        raise InputError(
            f"A procedural model has at least 31 rows and an odd number of columns from 31 on; got "
            f"{rows} and {columns}."
        )
    azimuth, elevation = _compute_axes(rows, columns)
    number, triangles = _triangulate(_select_face(azimuth, elevation))
    row, column = np.nonzero(number >= 0)
    radial = _compute_modes(number)
    flat = np.cos(elevation[row])
    angle = azimuth[column]
    direction = np.stack([flat * np.sin(angle), np.sin(elevation[row]), flat * np.cos(angle)], 1)
    mean = radial.mean[:, None] * direction
    scale = HEIGHT / np.ptp(mean[:, 1])
    chart = np.stack([angle / azimuth[-1], elevation[row] / elevation[0]], 1)
    return ShapeModel(
        scale * mean,
        radial.modes[:, :, None] * direction,
        scale**2 * radial.variances,
        triangles,
        (chart + 1) / 2,
        triangles,
        _place_landmarks(number, azimuth, elevation),
        name="the procedural face",
    )


def _compute_axes(
    rows: int, columns: int
) -> tuple[Float[np.ndarray, "columns"], Float[np.ndarray, "rows"]]:
    from skinnet.shape._procedural_head import compute_chart_angles

    azimuth, elevation = (
        axis.double().numpy().ravel() for axis in compute_chart_angles(rows, columns)
    )
    return (azimuth - azimuth[::-1]) / 2, elevation


def _select_face(
    azimuth: Float[np.ndarray, "columns"], elevation: Float[np.ndarray, "rows"]
) -> Bool[np.ndarray, "rows columns"]:
    width, height, middle, power = FACE_OUTLINE
    across, along = np.abs(azimuth / width), np.abs((elevation - middle) / height)
    inside: Bool[np.ndarray, "rows columns"] = along[:, None] ** power + across**power <= 1
    return inside


def _triangulate(
    inside: Bool[np.ndarray, "rows columns"],
) -> tuple[Int[np.ndarray, "rows columns"], Int[np.ndarray, "triangles 3"]]:
    """Number the vertices on the grid, -1 outside, and split each square inside into triangles."""
    square = inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]
    used = np.zeros_like(inside)
    for down in (slice(None, -1), slice(1, None)):
        for right in (slice(None, -1), slice(1, None)):
            used[down, right] |= square
    number = np.where(used, np.cumsum(used).reshape(used.shape) - 1, -1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    left = np.arange(square.shape[1]) < square.shape[1] // 2
    # The diagonals on the left mirror those on the right.
    first = np.where(left[:, None], np.stack([a, b, d], -1), np.stack([a, b, c], -1))
    second = np.where(left[:, None], np.stack([b, c, d], -1), np.stack([a, c, d], -1))
    return number, np.concatenate([first[square], second[square]])


class _RadialModes(NamedTuple):
    """Mean radius of the vertices, its orthonormal modes, and their variances."""

    mean: Float[np.ndarray, "vertices"]
    modes: Float[np.ndarray, "modes vertices"]
    variances: Float[np.ndarray, "modes"]


def _compute_modes(number: Int[np.ndarray, "rows columns"]) -> _RadialModes:
    """Compute principal components of the radius, which is all that differs between samples.

    They are computed on one half and mirrored to the other, so that both agree to the last bit.
    Vertices of the half count twice, except those of the middle column.
    """
    middle = number.shape[1] // 2
    half = number[:, middle:] >= 0
    radius = _sample_radius(half)
    mean = radius.mean(0)
    twice = np.where(np.nonzero(half)[1] > 0, 2, 1)
    values, vectors = np.linalg.eigh((radius - mean) * twice @ (radius - mean).T)
    values, vectors = values[: -MODES - 1 : -1], vectors[:, : -MODES - 1 : -1]
    modes = vectors.T @ (radius - mean) / np.sqrt(values)[:, None]
    # The sign of an eigenvector is free: the largest number of a mode is positive.
    peak = np.abs(modes).argmax(1)[:, None]
    modes *= np.sign(np.take_along_axis(modes, peak, 1))
    row, column = np.nonzero(number >= 0)
    place = np.full(half.shape, -1)
    place[half] = np.arange(len(mean))
    both = place[row, np.abs(column - middle)]
    return _RadialModes(mean[both], modes[:, both], values / (SAMPLES - 1))


def _sample_radius(half: Bool[np.ndarray, "rows half"]) -> Float[np.ndarray, "samples vertices"]:
    """Sample the radius of faces over the chart's right half and its middle column."""
    import torch

    from skinnet.shape._procedural_head import IDENTITY_SIZE, compute_head_radius

    rng = torch.Generator().manual_seed(0)
    numbers = torch.randn(SAMPLES // 2, IDENTITY_SIZE, generator=rng, dtype=torch.float64)
    rows, middle = half.shape[0], half.shape[1] - 1
    batches = torch.cat([numbers, -numbers]).split(25)
    heads = (
        compute_head_radius(each, rows, 2 * middle + 1)[:, 0, :, middle:].numpy()
        for each in batches
    )
    return np.concatenate([head[:, half] for head in heads])


def _place_landmarks(
    number: Int[np.ndarray, "rows columns"],
    azimuth: Float[np.ndarray, "columns"],
    elevation: Float[np.ndarray, "rows"],
) -> dict[str, int]:
    """Find the vertices nearest to `_LANDMARK_ANGLES`, and their mirror images."""
    found: dict[str, int] = {}
    for name, (across, along) in _LANDMARK_ANGLES.items():
        row = int(np.abs(elevation - along).argmin())
        column = int(np.abs(azimuth - across).argmin())
        found[name] = int(number[row, column])
        found[name.replace("left", "right")] = int(number[row, -1 - column])
    return {name: found[name] for name in IBUG}
