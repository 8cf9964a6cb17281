"""Cells of a face in two photographs: their mean colours, and what was read of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.faces._face_mesh import MESH_POINTS
from skinnet.images.resizing import resize
from skinnet.images.srgb import LUMINANCE_WEIGHTS, srgb_to_linear
from skinnet.inference._comparison.face_warp import FaceWarp, measure_face, sample_at
from skinnet.inference.decomposition import Decomposition

_CELLS = 18
"""Cells in a length of the face."""

_SAMPLES = 5
"""Samples of a cell in a row or column."""

_REACH = 1.5
"""How far cells reach from the middle of the face, in its lengths: to hair, neck and background."""

_CLIPPED, _DARK = 251, 6
"""Levels of 255 from which a channel is overexposed, and up to which a colour is mostly noise."""

_SPECULAR = 0.2
"""Specular reflection, relative to the light, from which the colour of skin is not its own."""

_BLACK, _DARKEST = 2e-3, 0.01
"""Linear value added before a logarithm, and the least of what is not skin in any channel."""

_SKIN, _OTHER, _FILLED = 0.75, 0.1, 0.5
"""Least mask of skin, and largest one of what is not, in both photographs; and the least part of a
cell whose samples can be used."""

_WINDOW, _FLAT, _SAME = 3, 0.03, 0.7
"""Side, in cells, of the window in which structure is compared; the least standard deviation of
log luminance that is structure; and the least correlation of the same thing in both."""

_MAPS = ("mask", "melanin", "hemoglobin", "specular", "shading")
_USABLE, _MASK = 3, 4
"""Channels of samples: linear red, green and blue, whether they can be used, and `_MAPS`."""


class Cells(NamedTuple):
    """Cells of a regular grid on the first photograph, those that can be compared.

    Attributes:
        addresses: Row and column in the grid, int [N, 2].
        grid_size: Rows, and columns, of the grid.
        corner: Column and row of the grid's corner in the first photograph, in pixels [2].
        side: Side of a cell in pixels of the first photograph.
        place: Distances from the middle of the face, right and down, in its lengths, [N, 2].
        colour: Log linear sRGB in both photographs, [N, 2, 3].
        spread: Standard deviation of the difference of log colour within each cell, [N].
        pigments: Log fractions of melanin and hemoglobin read in both, [N, 2, 2].
        gloss: Specular reflection over shading, mean of both, [N].
        skin: Whether a cell is skin in both, bool [N]; others are skin in neither.
        matches: Whether a cell is not skin, and the same thing in both photographs, bool [N].
    """

    addresses: NDArray[np.intp]
    grid_size: int
    corner: NDArray[np.float64]
    side: float
    place: NDArray[np.float64]
    colour: NDArray[np.float64]
    spread: NDArray[np.float64]
    pigments: NDArray[np.float64]
    gloss: NDArray[np.float64]
    skin: NDArray[np.bool_]
    matches: NDArray[np.bool_]

    @property
    def centres(self) -> NDArray[np.float64]:
        """Columns and rows of the centres in the first photograph, in pixels, [N, 2]."""
        centres: NDArray[np.float64] = (self.addresses[:, ::-1] + 0.5) * self.side + self.corner
        return centres


class _Grid(NamedTuple):
    """Where samples lie in the first photograph."""

    corner: NDArray[np.float64]
    middle: NDArray[np.float64]
    side: float

    @property
    def grid_size(self) -> int:
        return round(2 * _REACH * _CELLS)

    @property
    def points(self) -> NDArray[np.float64]:
        """Columns and rows [h, w, 2]."""
        steps = (np.arange(self.grid_size * _SAMPLES) + 0.5) * self.side / _SAMPLES
        return np.stack(np.meshgrid(*(start + steps for start in self.corner)), -1)

    def split(self, samples: NDArray[np.floating]) -> NDArray[np.float64]:
        """Samples [h, w, channels] of each cell, [cells, samples, channels]."""
        sides = (self.grid_size, _SAMPLES)
        parts = samples.reshape(*sides, *sides, -1).swapaxes(1, 2)
        return parts.reshape(self.grid_size**2, _SAMPLES**2, -1).astype(np.float64)


class _Sheet(NamedTuple):
    """The channels of what was read of a photograph, no finer than needed."""

    channels: NDArray[np.float32]
    offset: NDArray[np.float64]
    scale: NDArray[np.float64]

    def sample(self, points: NDArray[np.float64]) -> NDArray[np.float32]:
        """Sample at points of the photograph; NaN outside."""
        return sample_at(self.channels, (points - self.offset) * self.scale)


def sample_cells(
    photos: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    decompositions: tuple[Decomposition, Decomposition],
    warp: FaceWarp,
) -> Cells:
    """Sample the cells of a face in two photographs.

    What is not skin is looked for where the face has moved it to, and where it was if both
    photographs have one size: a camera on a tripod sees the same wall at the same place.

    Args:
        photos: Both photographs, uint8 sRGB [H, W, 3].
        decompositions: What was read of them; both have landmarks.
        warp: From the first to the second photograph.

    Returns:
        Their cells.
    """
    landmarks = get_landmarks(decompositions[0])
    length = measure_face(landmarks)
    middle = landmarks[:MESH_POINTS].astype(np.float64).mean(0)
    grid = _Grid(middle - _REACH * length, middle, length / _CELLS)
    sheets = [_make_sheet(*pair) for pair in zip(photos, decompositions, strict=True)]
    first, second = sheets[0].sample(grid.points), sheets[1].sample(warp.map(grid.points))
    match = correlate_structure(first, second)
    if photos[0].shape == photos[1].shape:
        still = sheets[1].sample(grid.points)
        again = correlate_structure(first, still)
        stayed = (again > match) & ~(second[..., _MASK] > _OTHER)
        second = np.where(stayed[..., None], still, second)
        match = np.where(stayed, again, match)
    return _average(grid, np.stack([grid.split(first), grid.split(second)], 1), match)


def get_landmarks(decomposition: Decomposition) -> NDArray[np.float32]:
    """The landmarks of a decomposition of a face."""
    landmarks = decomposition.landmarks
    assert landmarks is not None
    return landmarks


def _make_sheet(photo: NDArray[np.uint8], decomposition: Decomposition) -> _Sheet:
    box, crop = decomposition.box, photo[decomposition.box.slices]
    scale = min(1.0, _CELLS * _SAMPLES / measure_face(get_landmarks(decomposition)))
    width, height = (max(2, round(side * scale)) for side in (box.width, box.height))
    brightest = crop.max(-1)
    usable = (brightest < _CLIPPED) & (brightest > _DARK)
    usable &= decomposition.specular[box.slices] < _SPECULAR
    maps = [usable.astype(np.float32)]
    maps += [getattr(decomposition, name)[box.slices] for name in _MAPS]
    linear = srgb_to_linear(resize(crop, width, height))
    small = np.stack([resize(one, width, height) for one in maps], -1)
    ratio = np.array([width / box.width, height / box.height])
    corner = np.array([box.left, box.top], np.float64)
    return _Sheet(np.concatenate([linear, small], -1), corner, ratio)


def correlate_structure(
    first: NDArray[np.float32], second: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Correlate the structure of log luminance around each sample [h, w]; 0 where there is none.

    Args:
        first: Samples [h, w, channels], the first three of them linear sRGB.
        second: The same of the second photograph.

    Returns:
        Correlations in [-1, 1].
    """
    details = []
    for samples in (first, second):
        light = np.nan_to_num(samples[..., :3]).astype(np.float64) @ LUMINANCE_WEIGHTS
        log = ndimage.uniform_filter(np.log(np.maximum(light, 0) + _DARKEST), 2)
        details.append(log - _blur(log))
    a, b = details
    power = np.maximum(_blur(a * a), _FLAT**2) * np.maximum(_blur(b * b), _FLAT**2)
    seen = np.isfinite(first[..., 0]) & np.isfinite(second[..., 0])
    correlation: NDArray[np.float64] = np.where(seen, _blur(a * b) / np.sqrt(power), 0.0)
    return correlation


def _blur(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(ndimage.uniform_filter(values, _WINDOW * _SAMPLES))


def _average(grid: _Grid, samples: NDArray[np.float64], match: NDArray[np.float64]) -> Cells:
    """Average the samples [cells, 2, samples, channels] that are the same kind in both."""
    masks = samples[..., _MASK]
    usable = (np.nan_to_num(samples[..., _USABLE]) > 0.9).all(1)
    kinds = np.stack([usable & (masks > _SKIN).all(1), usable & (masks < _OTHER).all(1)])
    filled = kinds.mean(-1) >= _FILLED
    kept = np.flatnonzero(filled.any(0))
    skin = filled[0, kept]
    pixels = np.where(skin[:, None], kinds[0, kept], kinds[1, kept])
    values = np.where(pixels[:, None, :, None], samples[kept], 0)
    means = values.sum(2) / pixels.sum(-1)[:, None, None]
    maps = np.maximum(means[..., _MASK + 1 :], 1e-4)
    colour = np.log(np.maximum(means[..., :3], 0) + _BLACK)
    index = np.stack(np.unravel_index(kept, (grid.grid_size, grid.grid_size)), -1)
    centres = (index[:, ::-1] + 0.5) * grid.side + grid.corner
    alike = grid.split(match[..., None])[kept].mean((1, 2)) > _SAME
    return Cells(
        index,
        grid.grid_size,
        grid.corner,
        grid.side,
        (centres - grid.middle) / (grid.side * _CELLS),
        colour,
        _measure_spread(values[..., :3], pixels),
        np.log(maps[..., :2]),
        (maps[..., 2] / np.maximum(maps[..., 3], 0.05)).mean(1),
        skin,
        ~skin & alike & (means[..., :3] > _DARKEST).all((1, 2)),
    )


def _measure_spread(linear: NDArray[np.float64], pixels: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Standard deviation of the difference of chroma over the pixels [N, samples] of each cell."""
    logs = np.log(np.maximum(linear, 0) + _BLACK)
    difference = logs[:, 1] - logs[:, 0]
    chroma = difference - difference.mean(-1, keepdims=True)
    number = pixels.sum(-1)
    inside = pixels[..., None]
    mean = np.where(inside, chroma, 0).sum(1) / number[:, None]
    squares = np.where(inside, (chroma - mean[:, None]) ** 2, 0).sum((1, 2))
    spread: NDArray[np.float64] = np.sqrt(squares / (2 * number))
    return spread
