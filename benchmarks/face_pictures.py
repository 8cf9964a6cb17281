"""Pictures made of portraits, with the boxes of the faces: turned, half hidden, small, groups."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from benchmarks.portrait_faces import KnownFace
from skinnet.images import Box, resize
from skinnet.images.faces._face_place import to_box
from skinnet.images.faces._turned_square import TurnedSquare

Photo = NDArray[np.uint8]


class FacePicture(NamedTuple):
    """A picture uint8 [H, W, 3], and the boxes of its faces."""

    photo: Photo
    boxes: list[Box]


def turn(photo: Photo, box: Box, degrees: float) -> FacePicture:
    """Turn a picture clockwise; the corners get its mean colour."""
    fill = tuple(round(channel) for channel in photo.reshape(-1, 3).mean(0))
    turned = Image.fromarray(photo).rotate(
        -degrees, Image.Resampling.BICUBIC, expand=True, fillcolor=fill
    )
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    x, y = (box.left + box.right - photo.shape[1]) / 2, (box.top + box.bottom - photo.shape[0]) / 2
    centre = turned.width / 2 + x * cos - y * sin, turned.height / 2 + x * sin + y * cos
    return FacePicture(np.asarray(turned), [to_box(TurnedSquare(*centre, box.width))])


def shrink(photo: Photo, box: Box, ratio: float) -> FacePicture:
    """Resize a picture by a ratio."""
    height, width = (max(1, round(ratio * side)) for side in photo.shape[:2])
    scaled = Box(*(round(ratio * edge) for edge in box))
    return FacePicture(resize(photo, width, height), [scaled])


def hide_half(photo: Photo, box: Box, number: int) -> FacePicture:
    """Cover the left, right, upper or lower half of a face; `number` chooses half and cover."""
    image = Image.fromarray(photo)
    half = _HALVES[number % len(_HALVES)](box)
    cover = _COVERS[number // len(_HALVES) % len(_COVERS)]
    cover(ImageDraw.Draw(image), half, _find_skin(photo, box))
    return FacePicture(np.asarray(image), [box])


Colour = tuple[int, ...]

_HALVES: tuple[Callable[[Box], Box], ...] = (
    lambda box: box._replace(right=(box.left + box.right) // 2),
    lambda box: box._replace(left=(box.left + box.right) // 2),
    lambda box: box._replace(bottom=(box.top + box.bottom) // 2),
    lambda box: box._replace(top=(box.top + box.bottom) // 2),
)


def _find_skin(photo: Photo, box: Box) -> Colour:
    """Median colour of the middle of a face."""
    middle = Box(*(round(edge) for edge in np.average([box, _centre(box)], 0, (1, 2))))
    return tuple(int(channel) for channel in np.median(photo[middle.slices].reshape(-1, 3), 0))


def _centre(box: Box) -> Box:
    x, y = (box.left + box.right) // 2, (box.top + box.bottom) // 2
    return Box(x, y, x, y)


def _cover_dark(draw: ImageDraw.ImageDraw, half: Box, skin: Colour) -> None:
    draw.rectangle(half, fill=(25, 25, 30))


def _cover_light(draw: ImageDraw.ImageDraw, half: Box, skin: Colour) -> None:
    draw.rectangle(half, fill=(235, 235, 230))


def _cover_skin(draw: ImageDraw.ImageDraw, half: Box, skin: Colour) -> None:
    draw.rectangle(half, fill=skin)


def _cover_hand(draw: ImageDraw.ImageDraw, half: Box, skin: Colour) -> None:
    """Draw four fingers over a half, side by side, with darker edges between them."""
    edge = tuple(round(0.7 * channel) for channel in skin)
    width = half.width / 4
    for finger in range(4):
        left = half.left + finger * width
        shape = (
            left,
            half.top - (0.1, 0.2, 0.22, 0.12)[finger] * half.height,
            left + width,
            half.bottom,
        )
        draw.rounded_rectangle(
            shape, width / 2.2, fill=skin, outline=edge, width=max(1, round(width / 12))
        )


_COVERS = (_cover_hand, _cover_skin, _cover_dark, _cover_light)


def make_group(known: Sequence[KnownFace], rng: np.random.Generator) -> FacePicture:
    """Put portraits beside each other, of several sizes, some overlapping their neighbours."""
    width, height = _GROUP_SIZE
    columns = math.ceil(math.sqrt(len(known) * width / height))
    cell = np.array([width / columns, height / math.ceil(len(known) / columns)])
    canvas = np.full((height, width, 3), rng.integers(40, 220, 3), np.uint8)
    boxes: list[Box] = []
    for number in rng.permutation(len(known)):
        photo = known[number].read()
        fit = min(cell / photo.shape[1::-1]) * rng.uniform(0.5, 1.25)
        small = shrink(photo, known[number].box, fit)
        middle = cell * (
            np.array(divmod(number, columns))[::-1] + 0.5 + rng.uniform(-0.06, 0.06, 2)
        )
        sides = small.photo.shape[1::-1]
        left, top = (
            int(np.clip(round(place - side / 2), 0, most - side))
            for place, side, most in zip(middle, sides, _GROUP_SIZE, strict=True)
        )
        canvas[top : top + sides[1], left : left + sides[0]] = small.photo
        box = small.boxes[0]
        boxes.append(Box(box.left + left, box.top + top, box.right + left, box.bottom + top))
    return FacePicture(canvas, boxes)


_GROUP_SIZE = (1440, 1080)
"""Width and height of a group's picture, in pixels."""
