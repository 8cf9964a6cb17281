"""A white, grey or coloured reference at a place of a photograph."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.picture import Picture
from skinnet.images.srgb import linear_to_srgb

Array = NDArray[np.float64]

_SHARE, _LEAST_HALF = 0.004, 2
"""Half of the side of the square around a point, as a share of the picture's longer side, and at
least, in pixels."""

_CLIPPED, _CLIPPED_SHARE = 0.955, 0.02
"""Linear value from which a channel is saturated (250 of 255), and the share of pixels that may
be."""

_MOST_SPREAD = 0.25
"""Largest standard deviation of the brightness, relative to its mean: a shadow or an edge has
more."""

_HEX = re.compile(r"#?([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$", re.IGNORECASE)

_COLOUR_HELP = (
    "give the share of light that it reflects, such as 0.18 or 18%, or its colour in sRGB, such as "
    "230,225,210 or #e6e1d2"
)


class Card(NamedTuple):
    """What a reference is, apart from light and camera.

    Attributes:
        reflectance: Share of the light that it reflects; None if it is not known.
        colour: Linear sRGB [3] under D65; None for something white or grey.
        levels: The same as sRGB in integers of 0 to 255.
    """

    reflectance: float | None = None
    colour: tuple[float, float, float] | None = None
    levels: tuple[int, ...] | None = None


class Sample(NamedTuple):
    """The colour of a reference in a photograph.

    Attributes:
        display: sRGB [3] in [0, 1].
        name: What it is called in messages.
        clipped: How much of it is overexposed, in words; empty if it is not.
    """

    display: Array
    name: str
    clipped: str


def read_place(text: str) -> tuple[int, ...]:
    """Read X,Y or X0,Y0,X1,Y1.

    Raises:
        InputError: It is neither.
    """
    try:
        numbers = tuple(int(word) for word in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (2, 4):
        raise InputError(
            "--white is a point X,Y or a box X0,Y0,X1,Y1 in pixels from the upper left corner of "
            f"the picture; got {text!r}."
        )
    return numbers


def read_card(text: str | None) -> Card:
    """Read the reflectance or the colour of a reference; None for something white or grey.

    Raises:
        InputError: It is neither.
    """
    if text is None:
        return Card()
    found = _HEX.match(text.strip())
    words = text.replace(" ", "").split(",")
    try:
        if found is not None:
            return make_card([int(each, 16) for each in found.groups()])
        if len(words) == 1:
            share = float(words[0].removesuffix("%"))
            return make_card(share / 100 if words[0].endswith("%") else share)
        return make_card([int(word) for word in words])
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"--white-colour is {text!r}; {_COLOUR_HELP}.") from error


def make_card(known: float | Sequence[int] | None) -> Card:
    """Make a card of its reflectance in [0.01, 1], or of its sRGB in integers of 0 to 255.

    Raises:
        InputError: It is neither.
    """
    if known is None:
        return Card()
    if isinstance(known, int | float):
        if not 0.01 <= known <= 1:
            raise InputError(
                f"The reflectance of a reference is a share in [0.01, 1]; got {known:g}; "
                f"{_COLOUR_HELP}."
            )
        return Card(float(known))
    levels = np.asarray(known)
    if levels.shape != (3,) or levels.min() < 0 or levels.max() > 255 or levels.max() < 20:
        raise InputError(f"The colour of a reference is {known!r:.60}; {_COLOUR_HELP}.")
    value = levels / 255
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    red, green, blue = np.maximum(linear, 1e-3).tolist()
    return Card(None, (red, green, blue), tuple(int(level) for level in levels))


def measure_colour(picture: Picture, place: tuple[int, ...]) -> Sample:
    """Measure the mean colour at a point or in a box of a picture.

    Raises:
        InputError: The place is not in the picture, or what is there is transparent or uneven.
    """
    box = _make_box(picture, place)
    alpha = None if picture.alpha is None else picture.alpha[box.slices]
    if alpha is not None and (alpha < np.iinfo(alpha.dtype).max).any():
        raise InputError(
            f"The white reference in {picture.name} is transparent; give another place."
        )
    part = Picture(
        picture.name, picture.pixels[box.slices], colour_space=picture.colour_space
    ).linear()
    pixels = part.reshape(-1, 3).astype(np.float64)
    where = f"at {_describe(place)} in {picture.name}"
    display = linear_to_srgb(pixels.mean(0)).astype(np.float64)
    share = float((pixels >= _CLIPPED).any(-1).mean())
    if share > _CLIPPED_SHARE:
        clipped = f" in {share:.0%} of its pixels, which hides its true colour"
        return Sample(display, name_reference(display, where), clipped)
    brightness = pixels.mean(-1)
    if brightness.std() > _MOST_SPREAD * max(float(brightness.mean()), 0.02):
        raise InputError(
            f"The white reference {where} is uneven: a shadow or an edge lies in it. Give a box in "
            "which it has one colour."
        )
    return Sample(display, name_reference(display, where), "")


def name_reference(display: Array, where: str = "") -> str:
    """Name a reference by its sRGB [3] in [0, 1], and by its place."""
    levels = ", ".join(f"{level:.0f}" for level in 255 * display)
    return f"The white reference ({levels}) {where}".rstrip()


def _make_box(picture: Picture, place: tuple[int, ...]) -> Box:
    height, width = picture.pixels.shape[:2]
    is_whole = all(isinstance(each, int | np.integer) for each in place)
    if len(place) not in (2, 4) or not is_whole:
        raise InputError(f"A place is (x, y) or (x0, y0, x1, y1) in pixels; got {place!r:.60}.")
    if len(place) == 2:
        half = max(_LEAST_HALF, round(_SHARE * max(height, width)))
        x, y = place
        inside = 0 <= x < width and 0 <= y < height
        box = Box(
            max(x - half, 0), max(y - half, 0), min(x + half + 1, width), min(y + half + 1, height)
        )
    else:
        box = Box(*place)
        inside = 0 <= box.left < box.right <= width and 0 <= box.top < box.bottom <= height
    if not inside:
        raise InputError(
            f"The white reference {_describe(place)} is not in {picture.name}, which has {width} x "
            f"{height} pixels; give x from 0 to {width - 1} and y from 0 to {height - 1}, the "
            "smaller ones of a box first."
        )
    return box


def _describe(place: tuple[int, ...]) -> str:
    return ",".join(map(str, place))
