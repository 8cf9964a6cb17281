"""Faces that cannot be read: too small, mostly outside the photograph, drawn, or without colour."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._colour_content import check_colour
from skinnet.images.box import Box
from skinnet.images.faces._turned_square import TurnedSquare
from skinnet.images.faces.face import Face
from skinnet.inference._head_crop import HeadCrop, place_face_in_cut

_LEAST_WIDTH = 24
"""Smallest width of a face, in pixels."""

_LEAST_INSIDE, _MOST_INSIDE = 0.5, 0.9
"""Share of a face inside the photograph below which it is refused, and below which that is said."""

_COLOUR_SIZE, _FLAT_SIZE, _STEPS = 512, 96, 32
"""Largest sizes, in pixels, at which the colours of a turned head and the flatness of a face are
judged; and points across a face that are looked for in the photograph."""

_FLAT_SHARE = 0.25
"""Share of a face in one and the same colour above which it is drawn. The most of 1,757 portraits
is 0.13, and 0.17 after darkening, blurring or JPEG of quality 10; the least of drawings without
shading is 0.41."""

_COLOUR_WIDTH, _MIDDLE, _DARK, _WHITE = 5, 160.0, 24, 250
"""Levels of one colour, if the face's middle brightness is the second number; the brightness below
which levels are too few to tell; and the level from which pixels are saturated."""


def check_face(
    photo: NDArray[np.uint8], crop: HeadCrop, face: Face, who: str, name: str
) -> tuple[str, ...]:
    """Check that a face can be read.

    Args:
        photo: uint8 sRGB [H, W, 3].
        crop: The head's part of it.
        face: The face.
        who: The beginning of a sentence, such as "The face in a.jpg".
        name: Name of the photograph.

    Returns:
        Sentences that the user should read.

    Raises:
        InputError: It cannot.
    """
    if face.box.width < _LEAST_WIDTH:
        raise InputError(
            f"{who} is {face.box.width} pixels wide, and {_LEAST_WIDTH} are needed; give the "
            "picture at its full size."
        )
    inside = float(_find_inside(face, photo.shape, _STEPS).mean())
    if inside < _LEAST_INSIDE:
        raise InputError(
            f"{who} is only {inside:.0%} inside the picture, and half of it is needed; give a "
            "picture of the whole face."
        )
    _refuse_drawing(photo, face, who)
    _check_colour(photo, crop, face, name)
    if inside >= _MOST_INSIDE:
        return ()
    return (f"{who} is only {inside:.0%} inside the picture; its means are those of this part.",)


def _find_inside(face: Face, photo: tuple[int, ...], size: int) -> NDArray[np.bool_]:
    """Whether pixels [size, size] of the face are inside a photograph of a shape [H, W, ...]."""
    points = np.stack(np.meshgrid(*[np.arange(size) + 0.5] * 2), -1)
    x, y = np.moveaxis(_place_square(face).place(points, size), -1, 0)
    inside: NDArray[np.bool_] = (x > 0) & (y > 0) & (x < photo[1]) & (y < photo[0])
    return inside


def _refuse_drawing(photo: NDArray[np.uint8], face: Face, who: str) -> None:
    size = min(_FLAT_SIZE, face.box.width)
    inside = _find_inside(face, photo.shape, size)
    share = _measure_flat_share(_place_square(face).cut(photo, size)[inside])
    if share > _FLAT_SHARE:
        raise InputError(
            f"{who} seems to be drawn: {share:.0%} of it has one and the same colour. Give a "
            "photograph; --region skin (in Python region='skin') reads it all the same."
        )


def _measure_flat_share(face: NDArray[np.uint8]) -> float:
    """The largest share of a face's pixels [n, 3] in one colour that is not saturated."""
    brightness = face.max(-1)
    middle = float(np.median(brightness))
    if middle < _DARK:
        return 0.0
    levels = face[brightness < _WHITE] * (_MIDDLE / middle / _COLOUR_WIDTH)
    counts = [
        np.unique((levels + shift).astype(int) @ (1, 1000, 1000000), return_counts=True)[1]
        for shift in product((0, 0.5), repeat=3)
    ]
    most = max((int(each.max()) for each in counts if each.size), default=0)
    return float(most / brightness.size)


def _check_colour(photo: NDArray[np.uint8], crop: HeadCrop, face: Face, name: str) -> None:
    if crop.square is None:
        check_colour(photo, crop.box, face.box, name)
        return
    size = min(round(crop.square.side), _COLOUR_SIZE)
    upright = crop.square.cut(photo, size)
    check_colour(upright, Box(0, 0, size, size), place_face_in_cut(size), name)


def _place_square(face: Face) -> TurnedSquare:
    x, y = (face.box.left + face.box.right) / 2, (face.box.top + face.box.bottom) / 2
    return TurnedSquare(x, y, face.box.width, math.radians(face.tilt))
