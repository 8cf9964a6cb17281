"""The part of a photograph that the encoder sees: a square around a head, cut upright.

Only the encoder's input is turned, and only its small maps are turned back. So nothing of the
photograph's full size is resampled.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images.box import Box
from skinnet.images.faces._outlines import fill_outlines
from skinnet.images.faces._turned_square import TurnedSquare
from skinnet.images.faces.face import Face
from skinnet.images.faces.framing import HEAD_CENTRE, frame_head
from skinnet.images.resizing import resize
from skinnet.inference._editing import FADE, fade_edges
from skinnet.inference.onnx_model import _SD_NAMES, MAP_NAMES

_UPRIGHT = 8.0
"""Largest tilt, in degrees, of heads that are read as they are; the network learnt from such."""

_OUTSIDE = 0.02
"""Largest part of a face's side outside the photograph for its head to be read as it is."""

_MARGIN = 2.0
"""Side of the square around the head in sides of the face's box, and of the one around a whole
photograph in its longer sides."""

_MIN_SIDE = 16
"""Smallest side, in pixels, of the encoder's input."""

Arrays = Mapping[str, NDArray[np.float32]]


class HeadCrop(NamedTuple):
    """The part of a photograph that is read.

    Attributes:
        box: Its rectangle in the photograph; the maps are those of this rectangle.
        square: The square around the head, turned as the head is; None if the rectangle is read as
            it is.
    """

    box: Box
    square: TurnedSquare | None = None

    def cut(self, photo: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
        """Cut it from a photograph [H, W, 3], upright, with a longer side of `size` pixels."""
        if self.square is not None:
            return _cut_smoothly(self.square, photo, size)
        scale = size / max(self.box.height, self.box.width)
        sides = (self.box.width, self.box.height)
        width, height = (max(_MIN_SIDE, round(side * scale)) for side in sides)
        return resize(photo[self.box.slices], width, height)

    def turn_back(self, outputs: Arrays, size: int) -> dict[str, NDArray[np.float32]]:
        """Turn the encoder's maps of the cut of `size` pixels back, onto the rectangle.

        Outside the square, maps continue their values at its sides, and the mask is 0.
        """
        if self.square is None:
            return dict(outputs)
        names = (*MAP_NAMES, *_SD_NAMES, "mask")
        turned = {name: self._turn_map(outputs[name][0], size) for name in names}
        inside = np.pad(np.ones((size, size), np.float32), 1)
        turned["mask"] *= self._turn_map(inside, size, margin=1)
        return dict(outputs) | {name: values[None] for name, values in turned.items()}

    def find_inside(self) -> NDArray[np.bool_]:
        """Which pixels [H, W] of the rectangle are read: those inside the square."""
        if self.square is None:
            return np.ones((self.box.height, self.box.width), np.bool_)
        return fill_outlines([self.square.corners], box=self.box).inside

    def fade(self, shape: tuple[int, ...], photo: tuple[int, ...]) -> NDArray[np.float32]:
        """Weights [h, w] of the rectangle that fall to 0 at sides inside the photograph.

        Without them, an edit of a neck would end in a straight line.
        """
        if self.square is None:
            return fade_edges(shape, self.box, photo)
        sides = np.array([[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]])
        x, y = self.square.place(sides, 1).T
        is_inside = (x > 0) & (y > 0) & (x < photo[1]) & (y < photo[0])
        u, v = self._place_grid(shape, 1)
        distances = np.stack([v, 1 - u, 1 - v, u])[is_inside] / FADE
        weights: NDArray[np.float32] = distances.min(0, initial=1).clip(0, 1).astype(np.float32)
        return weights

    def _turn_map(
        self, values: NDArray[np.float32], size: int, margin: int = 0
    ) -> NDArray[np.float32]:
        """Turn values [h, w] or [h, w, C] of a cut with a margin of some pixels back."""
        assert self.square is not None
        scale = size / self.square.side
        shape = [max(1, round(side * scale)) for side in (self.box.height, self.box.width)]
        u, v = self._place_grid((shape[0], shape[1]), size)
        at = np.stack([v, u]) - 0.5 + margin
        channels = values[..., None] if values.ndim == 2 else values
        turned = [
            ndimage.map_coordinates(channel, at, order=1, mode="nearest")
            for channel in np.moveaxis(channels, -1, 0)
        ]
        return np.asarray(turned[0] if values.ndim == 2 else np.stack(turned, -1), np.float32)

    def _place_grid(self, shape: tuple[int, ...], size: int) -> NDArray[np.float64]:
        """Columns and rows [2, h, w], in a cut of `size` pixels, of the rectangle's pixels."""
        assert self.square is not None
        matrix = self.square.matrix(size)
        rows, columns = shape[:2]
        x = self.box.left + (np.arange(columns) + 0.5) * self.box.width / columns
        y = self.box.top + (np.arange(rows) + 0.5) * self.box.height / rows
        points = np.stack(np.meshgrid(x, y)) - matrix[:, 2, None, None]
        grid: NDArray[np.float64] = np.einsum("ij,jhw->ihw", np.linalg.inv(matrix[:, :2]), points)
        return grid


def crop_head(face: Face, photo: tuple[int, ...]) -> HeadCrop:
    """The square around a head in a photograph of a shape [H, W, ...].

    A rectangle without a part of the face is not like what the network learnt from; a square that
    is continued outside the photograph is.
    """
    height, width = photo[:2]
    if abs(face.tilt) <= _UPRIGHT and _is_inside(face.box, width, height):
        return HeadCrop(frame_head(face.box, width, height, _MARGIN))
    square = _turn_square(face)
    return HeadCrop(_bound(square, width, height), square)


def _is_inside(face: Box, width: int, height: int) -> bool:
    least = -_OUTSIDE * face.width
    return min(face.left, face.top, width - face.right, height - face.bottom) >= least


def crop_patch(photo: tuple[int, ...]) -> HeadCrop:
    """A whole photograph of a shape [H, W, ...] that shows skin without a face.

    The encoder sees it amid its mirror images: it learnt that skin is in the middle of a picture,
    and background at the sides.
    """
    height, width = photo[:2]
    square = TurnedSquare(width / 2, height / 2, _MARGIN * max(width, height))
    return HeadCrop(Box(0, 0, width, height), square)


def place_face_in_cut(size: int) -> Box:
    """The face's box in the cut of a turned head of `size` pixels."""
    side = size / _MARGIN
    left, top = (size - side) / 2, size / 2 - HEAD_CENTRE * side
    return Box(round(left), round(top), round(left + side), round(top + side))


def _turn_square(face: Face) -> TurnedSquare:
    """The square that `frame_head` places around an upright head, turned about the face."""
    box, tilt = face.box, math.radians(face.tilt)
    raised = (0.5 - HEAD_CENTRE) * box.height
    x = (box.left + box.right) / 2 + raised * math.sin(tilt)
    y = (box.top + box.bottom) / 2 - raised * math.cos(tilt)
    return TurnedSquare(x, y, _MARGIN * max(box.width, box.height), tilt)


def _bound(square: TurnedSquare, width: int, height: int) -> Box:
    """The part of a photograph that a square covers, as a rectangle."""
    left, top, right, bottom = _list_ends(square)
    return Box(max(0, left), max(0, top), min(right, width), min(bottom, height))


def _list_ends(square: TurnedSquare) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of a square, which may exceed the photograph."""
    x, y = square.corners.T
    return round(x.min()), round(y.min()), round(x.max()), round(y.max())


def _cut_smoothly(square: TurnedSquare, photo: NDArray[np.uint8], size: int) -> NDArray[np.uint8]:
    """Cut a square at twice the size, and average: a turned cut interpolates single pixels.

    What is outside the photograph is its mirror image: grey there would be read as darker skin.
    """
    left, top, right, bottom = _list_ends(square)
    box = _bound(square, photo.shape[1], photo.shape[0])
    scale = min(1.0, 2 * size / square.side)
    width, height = (max(1, round(side * scale)) for side in (box.width, box.height))
    columns = _scale(scale, box.left - left, right - box.right)
    rows = _scale(scale, box.top - top, bottom - box.bottom)
    part = resize(photo[box.slices], width, height)
    mirrored = np.pad(part, (rows, columns, (0, 0)), "symmetric")
    x = (square.x - box.left) * width / box.width + columns[0]
    y = (square.y - box.top) * height / box.height + rows[0]
    moved = TurnedSquare(x, y, square.side * scale, square.tilt)
    return resize(moved.cut(mirrored, 2 * size), size, size)


def _scale(scale: float, *lengths: int) -> tuple[int, ...]:
    """Lengths in whole pixels, and one more."""
    return tuple(math.ceil(length * scale) + 1 for length in lengths)
