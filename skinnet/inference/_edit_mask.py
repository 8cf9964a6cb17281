"""The mask of an edit, which the user paints: white is edited fully, grey partly, black not."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from skinnet.errors import InputError
from skinnet.images._walk import STDIN
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture

_LARGEST_DIFFERENCE = 0.08
"""Largest difference between red, green and blue of a grey, of white; conversions leave some."""

_DARKEST = 0.02
"""Least share of white that is not taken for black."""

_MEANING = "White is edited fully, grey partly, and black is left"


def read_edit_mask(path: Path, may_be_black: bool = False) -> NDArray[Any]:
    """Read a mask from a picture file, turned upright as its EXIF states.

    Its stored values are shares of its white, whatever its colour space. Transparent parts count
    as black.

    Args:
        path: The file.
        may_be_black: Whether it is one of several, so that it may be black everywhere.

    Returns:
        uint8 or uint16 [H, W].

    Raises:
        InputError: The file cannot be read, is coloured, or has nothing that would be edited.
    """
    if str(path) == STDIN:
        raise InputError("--mask takes a file, since standard input is for the photograph; got - .")
    picture = read_picture(path)
    values = _to_grey(_hide_transparent(picture), str(path))
    if values.any():
        _refuse_labels(values, str(path))
    elif not may_be_black:
        raise describe_black(path)
    return values


def describe_black(path: Path) -> InputError:
    """Make the error for a mask, or for all tiles of one, that is black."""
    return InputError(f"{path} is black everywhere, so nothing would be edited. {_MEANING}.")


def check_edit_mask(
    values: ArrayLike, shape: tuple[int, ...], name: str = "the photograph"
) -> NDArray[Any]:
    """Check a mask for a photograph of a name and a shape [H, W, ...], turned upright.

    Returns:
        The mask as an array.

    Raises:
        InputError: It has another shape, type or range.
    """
    mask = np.asarray(values)
    if mask.dtype.kind not in "buf" or (mask.dtype.kind == "u" and mask.dtype.itemsize > 2):
        raise InputError(
            f"A mask is bool, uint8, uint16 or floats in [0, 1]; got {mask.dtype}. Convert it with "
            "mask.astype(bool) if all of what is not 0 is to be edited."
        )
    if mask.shape != shape[:2]:
        raise InputError(_describe_size(mask.shape, shape, name))
    outside = mask[~((mask >= 0) & (mask <= 1))] if mask.dtype.kind == "f" else mask[:0]
    if outside.size:
        raise InputError(f"A mask of floats lies in [0, 1]; got {outside.flat[0]:g}.")
    if mask.dtype.kind == "u" and mask.any():
        _refuse_labels(mask, "The mask")
    return mask


def _hide_transparent(picture: Picture) -> NDArray[Any]:
    """The stored pixels, as far as they are transparent mixed with black."""
    pixels, alpha = picture.pixels, picture.alpha
    if alpha is None:
        return pixels
    weight = alpha if pixels.ndim == 2 else alpha[..., None]
    mixed = np.rint(pixels.astype(np.float64) * weight / np.iinfo(pixels.dtype).max)
    return np.asarray(mixed.astype(pixels.dtype))


def _to_grey(pixels: NDArray[Any], name: str) -> NDArray[Any]:
    if pixels.ndim == 2:
        return pixels
    if pixels.shape[2] != 3:
        raise InputError(f"{name} is CMYK, and a mask is grey. {_MEANING}; save it as grey.")
    difference = int((pixels.max(-1) - pixels.min(-1)).max())
    if difference > _LARGEST_DIFFERENCE * np.iinfo(pixels.dtype).max:
        raise InputError(f"{name} is coloured, and a mask is grey. {_MEANING}; save it as grey.")
    return np.asarray(pixels[..., 1])


def _refuse_labels(values: NDArray[Any], name: str) -> None:
    """Refuse masks that are black to the eye, such as labels of 0 and 1."""
    most, top = int(values.max()), int(np.iinfo(values.dtype).max)
    if most < _DARKEST * top:
        raise InputError(
            f"{name} is nearly black: its largest value is {most} of {top}. {_MEANING}; multiply "
            f"its values by {top // most} if {most} means to edit."
        )


def _describe_size(size: tuple[int, ...], shape: tuple[int, ...], name: str) -> str:
    if len(size) != 2:
        return f"A mask is [H, W]; got shape {list(size)}."
    found = " x ".join(str(side) for side in size[::-1])
    said = f"The mask has {found} pixels, and {name} {shape[1]} x {shape[0]}"
    if size == (shape[1], shape[0]):
        return f"{said}, once its EXIF orientation has turned it upright; turn the mask too."
    return f"{said}; give a mask of the photograph's size."
