"""RAW files to pictures in linear light, encoded as sRGB, without a tone curve."""

from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._raw.cameras import find_camera, list_close_names
from skinnet.images._raw.colours import (
    StatedMatrix,
    adapt_matrix,
    choose_matrix,
    read_stated_matrix,
)
from skinnet.images._raw.exif_block import read_raw_exif
from skinnet.images._shot import read_shot
from skinnet.images._silence import silence_libraw
from skinnet.images._tiff_structure import find_sensor_end
from skinnet.images.colour_space import ColourSpace
from skinnet.images.picture import Picture
from skinnet.images.srgb import linear_to_srgb

FORMAT = "RAW"
"""`Picture.format` of a RAW file."""

_REMEDY = "convert it to DNG, or develop it and save it as 16-bit TIFF or JPEG"
_TOP = 65535
_MOST_PIXELS = 16
"""Pixels that no format holds in a byte."""

_TIFF = (b"II*\0", b"MM\0*")
_STRIP = 256
"""Rows whose colours are computed at once; bounds the memory."""


def read_raw(data: bytes, name: str, largest: int, upright: bool = True) -> Picture:
    """Read a RAW file with LibRaw, never the previews in it.

    Values are balanced as the camera was set, and turned into linear sRGB as training does it. 1 is
    a full sensor: nothing is brightened, so that all pictures of one exposure stay comparable.

    Args:
        data: The content of the file.
        name: Name of the picture in messages.
        largest: Largest number of pixels.
        upright: Whether to apply the orientation that the file states.

    Returns:
        The picture, sRGB of 16 bits.

    Raises:
        InputError: `rawpy` is missing; LibRaw cannot read the file; its camera's colours are not
            known, or it has none; or it is too large.
    """
    rawpy = _import_rawpy(name)
    try:
        with silence_libraw, rawpy.RawPy() as raw:
            raw.open_buffer(BytesIO(data))
            _check(raw, name, largest)
            raw.unpack()
            _check_values(rawpy, raw, data)
            return _develop(rawpy, raw, data, name, upright)
    except InputError:
        raise
    except (rawpy.LibRawFileUnsupportedError, rawpy.LibRawNotImplementedError) as error:
        raise InputError(f"{name} is a RAW file that LibRaw does not read; {_REMEDY}.") from error
    except (rawpy.LibRawError, *READ_ERRORS) as error:
        reason = error.args[0] if error.args else error
        words = reason.decode("ascii", "replace") if isinstance(reason, bytes) else str(reason)
        raise InputError(
            f"{name} is a RAW file that is damaged or cut short ({words}); copy it from the camera "
            "again."
        ) from error


def _import_rawpy(name: str) -> Any:
    try:
        import rawpy
    except ModuleNotFoundError as error:
        raise InputError(
            f'{name} is a RAW file, which needs an extra: pip install "skinnet[raw]"; or develop '
            "it, and save it as 16-bit TIFF or JPEG."
        ) from error
    return rawpy


def _check(raw: Any, name: str, largest: int) -> None:
    sizes = raw.sizes
    if sizes.width * sizes.height > largest:
        raise InputError(
            f"{name} has {sizes.width} x {sizes.height}, more pixels than the limit of "
            f"{largest:,}; develop it at a smaller size, and save it as 16-bit TIFF or JPEG."
        )
    if raw.num_colors != 3:
        count = "no" if raw.num_colors == 1 else raw.num_colors
        raise InputError(
            f"{name} is a RAW file of a sensor of {count} colours, where 3 are needed; develop it, "
            "and save it as 16-bit TIFF or JPEG."
        )


def _check_values(rawpy: Any, raw: Any, data: bytes) -> None:
    """Find files that are cut, which LibRaw fills with black or noise in some formats.

    Raises:
        ValueError: The file is cut.
    """
    pixels = raw.sizes.raw_width * raw.sizes.raw_height
    is_tiff = data.startswith(_TIFF)
    if len(data) * _MOST_PIXELS < pixels or (
        is_tiff and find_sensor_end(BytesIO(data)) > len(data)
    ):
        raise ValueError("the sensor's values are missing in part")
    if raw.raw_type == rawpy.RawType.Flat:
        if raw.raw_image_visible.max() <= min(raw.black_level_per_channel):
            raise ValueError("the sensor's values are all black")


def _develop(rawpy: Any, raw: Any, data: bytes, name: str, upright: bool) -> Picture:
    exif, is_dng = read_raw_exif(data)
    shot = read_shot(exif)
    camera, stated = find_camera(shot.camera or ""), read_stated_matrix(raw, is_dng)
    matrix = choose_matrix(camera, stated)
    if matrix is None:
        raise _refuse_camera(name, shot.camera)
    balance, notes = _find_balance(raw, stated, name)
    if stated is not None:
        matrix = adapt_matrix(matrix, stated.daylight, balance)
    values = raw.postprocess(
        user_wb=[*balance, balance[1]],
        output_color=rawpy.ColorSpace.raw,
        output_bps=16,
        gamma=(1, 1),
        no_auto_bright=True,
        adjust_maximum_thr=0.0,  # white must not depend on what a picture shows
        user_flip=None if upright else 0,
    )
    if camera is None:
        notes += (_note_camera(name, shot.camera),)
    pixels = _encode(values, matrix)
    metadata = {"exif": exif} if exif else {}
    space = ColourSpace("sRGB", "RAW development")
    return Picture(name, pixels, None, space, FORMAT, metadata, notes)


def _find_balance(
    raw: Any, stated: StatedMatrix | None, name: str
) -> tuple[list[float], tuple[str, ...]]:
    """Factors of R, G and B of which green's is 1, and a note if the camera stated none."""
    factors = np.asarray(raw.camera_whitebalance[:3], float)
    if np.isfinite(factors).all() and factors.min() > 0:
        return (factors / factors[1]).tolist(), ()
    daylight = np.ones(3) if stated is None else 1 / stated.daylight
    note = f"{name} states no white balance; it is developed for daylight of 6,500 K."
    return (daylight / daylight[1]).tolist(), (note,)


def _encode(values: NDArray[np.uint16], matrix: NDArray[np.float64]) -> NDArray[np.uint16]:
    """Balanced values [H, W, 3] as sRGB."""
    table = np.rint(_TOP * linear_to_srgb(np.arange(_TOP + 1) / _TOP)).astype(np.uint16)
    pixels = np.empty_like(values)
    transposed = matrix.T.astype(np.float32)
    for top in range(0, len(values), _STRIP):
        linear = values[top : top + _STRIP] @ transposed
        pixels[top : top + _STRIP] = table[np.rint(linear.clip(0, _TOP)).astype(np.uint16)]
    return pixels


def _refuse_camera(name: str, camera: str | None) -> InputError:
    close = ", ".join(list_close_names(camera)) if camera else ""
    nearest = f" (the nearest names that are known: {close})" if close else ""
    return InputError(
        f"{name} is a RAW file of {camera or 'a camera without a name'}, whose colours are not "
        f"known{nearest}; {_REMEDY}."
    )


def _note_camera(name: str, camera: str | None) -> str:
    who = camera or "a camera that it does not name"
    return (
        f"{name} is from {who}, whose sensitivities are not measured; its colours are those of a "
        "usual camera, corrected by its colour matrix."
    )
