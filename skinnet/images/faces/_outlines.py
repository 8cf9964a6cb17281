"""Outlines of parts of a face: their pixels, their area, and depths inside them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from skinnet.images.box import Box

Outline = NDArray[np.floating]
"""Corners of a polygon [N, 2], in pixels from the photograph's upper left corner."""


class Patch(NamedTuple):
    """Some pixels of a photograph.

    Attributes:
        box: A box around them; it may exceed the photograph.
        inside: Which pixels of the box they are, bool [height, width].
    """

    box: Box
    inside: NDArray[np.bool_]

    @property
    def centres(self) -> NDArray[np.float64]:
        """Columns and rows of the pixels' centres [N, 2]."""
        rows, columns = np.nonzero(self.inside)
        return np.asarray(np.stack([columns + self.box.left, rows + self.box.top], -1) + 0.5)

    def choose(self, chosen: NDArray[np.bool_]) -> "Patch":
        """Some of the pixels; `chosen` [N] is in the order of `centres`."""
        inside = np.zeros_like(self.inside)
        inside[self.inside] = chosen
        return Patch(self.box, inside)

    def clip(self, height: int, width: int) -> "Patch":
        """The part within a photograph."""
        left, top = max(0, self.box.left), max(0, self.box.top)
        right = max(left, min(width, self.box.right))
        bottom = max(top, min(height, self.box.bottom))
        rows = slice(top - self.box.top, bottom - self.box.top)
        columns = slice(left - self.box.left, right - self.box.left)
        return Patch(Box(left, top, right, bottom), self.inside[rows, columns])


def frame_outlines(outlines: Sequence[Outline]) -> Box:
    """The smallest box of pixels around some outlines."""
    corners = np.concatenate(outlines).astype(np.float64)
    left, top = np.floor(corners.min(0)).astype(int).tolist()
    right, bottom = np.ceil(corners.max(0)).astype(int).tolist()
    return Box(left, top, max(right, left + 1), max(bottom, top + 1))


def fill_outlines(
    outlines: Sequence[Outline], holes: Sequence[Outline] = (), box: Box | None = None
) -> Patch:
    """The pixels inside any of the outlines and in none of the holes, within a box if given."""
    box = frame_outlines(outlines) if box is None else box
    image = Image.new("1", (box.width, box.height))
    draw = ImageDraw.Draw(image)
    for fill, each in ((1, outlines), (0, holes)):
        for outline in each:
            # Pillow counts from the centre of the first pixel.
            corners = outline.astype(np.float64) - (box.left, box.top) - 0.5
            draw.polygon([(x, y) for x, y in corners.tolist()], fill=fill)
    return Patch(box, np.array(image))


def mark_outlines(outlines: Sequence[Outline], shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Pixels [h, w] of a picture of a shape [h, w, ...] inside any of the outlines."""
    marked = np.zeros(shape[:2], np.bool_)
    patch = fill_outlines(outlines).clip(*shape[:2])
    marked[patch.box.slices] = patch.inside
    return marked


def measure_area(outline: Outline) -> float:
    """Area of an outline in pixels; negative if its corners run anticlockwise in the picture."""
    x, y = outline.astype(np.float64).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def measure_depth(points: NDArray[np.floating], outline: Outline) -> NDArray[np.float64]:
    """Distances of points [N, 2] inside an outline from its edges, in pixels [N]."""
    squares = np.full(len(points), np.inf)
    corners = outline.astype(np.float64)
    for start, end in zip(corners, np.roll(corners, -1, 0), strict=True):
        edge, way = end - start, points - start
        along = np.clip(way @ edge / max(float(edge @ edge), 1e-12), 0, 1)
        squares = np.minimum(squares, ((way - along[:, None] * edge) ** 2).sum(-1))
    return np.asarray(np.sqrt(squares))
