"""Arrays and tensors to pictures, or a sentence on what is ambiguous in them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._array_space import choose_space, encode_linear_light
from skinnet.images._decode import check_size
from skinnet.images._picture_sources import TensorLike, convert_tensor
from skinnet.images.colour_space import ColourSpace
from skinnet.images.picture import Picture

_CHANNELS = (1, 3, 4)
_TOP, _BYTE, _TWELVE_BITS = 65535, 255, 4095
_BATCH = "A batch of images is read one by one: Decomposer takes it; read_picture takes one of it."
_SIXTEEN_BITS = (
    "{} is uint16, whose white is 65535, and its largest value is {}. If its white is {}, multiply "
    "it by {}; else it is read as it is: very dark."
)


def read_array(array: Any, name: str, space: str | ColourSpace | None) -> Picture:
    """Read an array, channels last, or a tensor, channels first, as a picture.

    Floats become uint16, so that an edit keeps their depth. Values are copied.

    Args:
        array: The array or the tensor.
        name: Name of the picture in messages.
        space: Name of its colour space, or the space itself; None for sRGB.

    Raises:
        InputError: The array is of another type, shape or range, or could mean several things.
    """
    values = _to_channels_last(array)
    _check_kind(values)
    _check_shape(values)
    check_size(values.shape[1], values.shape[0], name)
    pixels, notes = _to_pixels(values, name)
    chosen, linear = choose_space(space)
    channels = values.shape[2] if values.ndim == 3 else 1
    colour = pixels[..., :3] if channels > 1 else pixels.reshape(pixels.shape[:2])
    alpha = pixels[..., 3].copy() if channels == 4 else None
    colour = encode_linear_light(colour) if linear else np.array(colour)
    if alpha is not None and alpha.dtype != colour.dtype:
        alpha = alpha.astype(np.uint16) * 257
    return Picture(name, colour, alpha, chosen, notes=notes)


def _to_channels_last(source: Any) -> NDArray[Any]:
    if not isinstance(source, TensorLike):
        return _to_array(source)
    values = convert_tensor(source)
    shape = list(values.shape)
    if values.ndim == 4:
        raise InputError(f"A tensor of one image is [3, H, W]; got shape {shape}. {_BATCH}")
    if values.ndim != 3:
        return values
    first, last = shape[0] in _CHANNELS, shape[2] in _CHANNELS
    if first and last:
        raise InputError(
            f"A tensor of shape {shape} could be [3, H, W] or [H, W, 3]; give an array of NumPy, "
            "whose channels are last: tensor.numpy() or tensor.permute(1, 2, 0).numpy()."
        )
    if not first:
        remedy = "Put the channels first: tensor.permute(2, 0, 1)." if last else ""
        raise InputError(
            f"A tensor of an image is [3, H, W], [1, H, W] or [4, H, W], as torch has it; got "
            f"shape {shape}. {remedy}".rstrip()
        )
    return np.moveaxis(values, 0, -1)


def _to_array(source: Any) -> NDArray[Any]:
    """An array as a plain one; a matrix and hidden values are refused."""
    if isinstance(source, np.matrix):
        raise InputError("A photograph is an array, and not an np.matrix; give np.asarray(it).")
    if isinstance(source, np.ma.MaskedArray) and np.ma.getmaskarray(source).any():
        raise InputError(
            "The array has masked values, which no photograph has; fill them: array.filled(0)."
        )
    try:
        values = np.asarray(source)
    except (TypeError, ValueError, RuntimeError) as error:
        kind = type(source).__name__
        raise InputError(f"A {kind} cannot be read as an array: {error}.") from error
    return values.view(np.ndarray)


def _check_kind(values: NDArray[Any]) -> None:
    if values.dtype == np.uint8 or values.dtype.kind == "f":
        return
    if values.dtype.kind == "u" and values.dtype.itemsize == 2:
        return
    remedy = "Divide it by its white first."
    if values.dtype.kind == "b":
        remedy = "A mask is no photograph."
    elif values.dtype.kind in "OV":
        remedy = "Give the images as a list of arrays, or a plain array of numbers."
    raise InputError(
        f"A photograph is uint8, uint16 or floats in [0, 1]; got {values.dtype}. {remedy}"
    )


def _check_shape(values: NDArray[Any]) -> None:
    shape = list(values.shape)
    is_grey = values.ndim == 2
    if values.size and (is_grey or (values.ndim == 3 and shape[2] in _CHANNELS)):
        return
    remedy = ""
    if values.ndim == 3 and shape[0] in _CHANNELS:
        remedy = " Put the channels last: array.transpose(1, 2, 0)."
    elif values.ndim == 4:
        remedy = f" {_BATCH}"
    raise InputError(f"A photograph is [H, W], [H, W, 3] or [H, W, 4]; got shape {shape}.{remedy}")


def _to_pixels(values: NDArray[Any], name: str) -> tuple[NDArray[Any], tuple[str, ...]]:
    """The values as uint8 or uint16, and what the user should read of them."""
    if values.dtype == np.uint8:
        return values, ()
    if values.dtype.kind == "f":
        return _round_floats(values), ()
    pixels = values.astype(np.uint16, copy=False)
    top = int(pixels[..., :3].max() if pixels.ndim == 3 else pixels.max())
    if 0 < top <= _BYTE:
        raise InputError(
            f"An array of uint16 has its white at {_TOP}, and the largest value of this one is "
            f"{top}. If its white is {_BYTE}, give array.astype(np.uint8)."
        )
    if 0 < top <= _TWELVE_BITS:
        white = 1023 if top <= 1023 else _TWELVE_BITS
        return pixels, (_SIXTEEN_BITS.format(name, top, white, (_TOP + 1) // (white + 1)),)
    return pixels, ()


def _round_floats(values: NDArray[Any]) -> NDArray[np.uint16]:
    outside = values[~((values >= 0) & (values <= 1))]
    if outside.size:
        found = float(outside[0])
        remedy = "Divide it by 255 if it was read from a file."
        if found < 0:
            remedy = "Undo its normalisation first."
        elif not np.isfinite(found):
            remedy = "Replace what is not a finite number."
        raise InputError(f"A photograph of floats lies in [0, 1]; got {found:g}. {remedy}")
    top = float(values.max())
    if 0 < top <= 1 / _BYTE:
        raise InputError(
            f"A photograph of floats has its white at 1, and the largest value of this one is "
            f"{top:.2g}. Was it divided by 255 twice?"
        )
    wide = values.astype(np.float32)
    wide *= _TOP
    return np.rint(wide).astype(np.uint16)
