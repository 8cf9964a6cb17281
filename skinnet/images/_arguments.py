"""Arguments of another type than was meant, refused in a sentence."""

from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError


def check_number(what: str, value: Any) -> float:
    """Return a number as a float; `what` begins the sentence that refuses anything else.

    Raises:
        InputError: It is no number, such as a text, an array or a complex number.
    """
    if not isinstance(value, Real) or isinstance(value, bool | np.bool_):
        raise InputError(f"{what} is a number; got {value!r:.60}.")
    try:
        return float(value)
    except OverflowError:
        return float("inf")  # an integer that is larger than any float


def check_text(what: str, value: Any) -> str:
    """Return a text.

    Raises:
        InputError: It is none.
    """
    if not isinstance(value, str):
        raise InputError(f"{what} is a text; got {value!r:.60}.")
    return value


def check_path(what: str, value: Any) -> Path:
    """Return a path from a text or a path.

    Raises:
        InputError: It is neither.
    """
    if not isinstance(value, str | PathLike):
        raise InputError(f"{what} is a path; got {value!r:.60}.")
    return Path(value)


def check_photo(photo: Any) -> NDArray[np.uint8]:
    """Return a photograph, uint8 sRGB [H, W, 3], as an array.

    Raises:
        InputError: It is another thing, or has another shape or type.
    """
    got = f"a {type(photo).__name__}"
    if isinstance(photo, np.ndarray):
        values: NDArray[np.uint8] = photo
        if photo.dtype == np.uint8 and photo.ndim == 3 and photo.shape[2] == 3:
            return values
        got = f"{photo.dtype} {list(photo.shape)}"
    raise InputError(
        f"This takes a photograph as uint8 sRGB [H, W, 3]; got {got}. "
        "skinnet.images.read_photo makes it from a file, an array or a tensor."
    )
