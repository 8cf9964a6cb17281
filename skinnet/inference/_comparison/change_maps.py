"""Maps of changes, and the second photograph warped onto the first one."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.box import Box
from skinnet.images.resizing import resize
from skinnet.inference._comparison.cells import Cells
from skinnet.inference._comparison.face_warp import FaceWarp, sample_at
from skinnet.inference._tiles import BLANK
from skinnet.inference.decomposition import SKIN_THRESHOLD, Decomposition

_LARGEST = 512
"""Longer side of the maps in pixels, where the photograph is larger."""


class Canvas(NamedTuple):
    """The part of the first photograph that maps show, and their size in pixels."""

    box: Box
    width: int
    height: int

    @classmethod
    def around(cls, box: Box) -> "Canvas":
        """The canvas of a box of the first photograph."""
        scale = min(1.0, _LARGEST / max(box.width, box.height))
        return cls(box, max(1, round(box.width * scale)), max(1, round(box.height * scale)))

    @property
    def points(self) -> NDArray[np.float64]:
        """Columns and rows of the pixels' centres in the first photograph [h, w, 2]."""
        x = self.box.left + (np.arange(self.width) + 0.5) * self.box.width / self.width
        y = self.box.top + (np.arange(self.height) + 0.5) * self.box.height / self.height
        return np.stack(np.meshgrid(x, y), -1)


def cut(photo: NDArray[np.uint8], canvas: Canvas) -> NDArray[np.uint8]:
    """Cut a canvas from the first photograph."""
    return resize(photo[canvas.box.slices], canvas.width, canvas.height)


def warp_photograph(
    photo: NDArray[np.uint8], box: Box, warp: FaceWarp, canvas: Canvas
) -> NDArray[np.uint8]:
    """Warp the second photograph, of which a box was read, onto a canvas; grey is outside."""
    scale = min(1.0, _LARGEST / max(box.width, box.height))
    size = [max(1, round(side * scale)) for side in (box.width, box.height)]
    small = resize(photo[box.slices], *size).astype(np.float32)
    ratio = np.array(size) / (box.width, box.height)
    padded = np.pad(small, ((1, 1), (1, 1), (0, 0)), "edge")
    sampled = sample_at(padded, (warp.map(canvas.points) - (box.left, box.top)) * ratio + 1)
    warped = np.where(np.isnan(sampled), np.array(BLANK, np.float32), sampled)
    pixels: NDArray[np.uint8] = np.rint(warped).astype(np.uint8)
    return pixels


def spread_changes(
    change: NDArray[np.float64], cells: Cells, decomposition: Decomposition, canvas: Canvas
) -> NDArray[np.float32]:
    """Spread the changes [skin cells, pigments] over the pixels of a canvas.

    Returns:
        [pigments, h, w]; NaN where there is no skin that was compared.
    """
    skin = cells.addresses[cells.skin]
    filled = np.zeros((cells.grid_size, cells.grid_size), bool)
    filled[tuple(skin.T)] = True
    nearest = ndimage.distance_transform_edt(~filled, return_distances=False, return_indices=True)
    at = np.moveaxis((canvas.points - cells.corner) / cells.side - 0.5, -1, 0)[::-1]
    near = ndimage.map_coordinates(filled.astype(np.float32), at, order=1) > SKIN_THRESHOLD
    mask = resize(decomposition.mask[canvas.box.slices], canvas.width, canvas.height)
    shown, maps = near & (mask > SKIN_THRESHOLD), []
    for values in change.T:
        grid = np.zeros((cells.grid_size, cells.grid_size))
        grid[tuple(skin.T)] = values
        spread = ndimage.map_coordinates(grid[tuple(nearest)], at, order=1, mode="nearest")
        maps.append(np.where(shown, spread, np.nan))
    return np.stack(maps).astype(np.float32)
