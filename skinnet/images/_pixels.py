"""Pixels of an open picture at their own depth: 8 or 16 bits, grey, RGB or CMYK, and alpha."""

from io import BytesIO
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._deep import read_deep

_EIGHT_BIT = frozenset("1 L LA La P PA RGB RGBA RGBa RGBX CMYK YCbCr HSV".split())
_STRAIGHT = {"La": "LA", "RGBa": "RGBA"}
_BITS, _COMPRESSION, _PHOTOMETRIC, _PLANES, _SAMPLE_FORMAT = 258, 259, 262, 284, 339
_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _CMYK = 0, 1, 2, 5
_JPEG_COMPRESSIONS = (6, 7)
_ASSOCIATED_ALPHA = 1
_ORIENTATION = 0x0112
_TRANSPOSES = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
_INVERSE = {6: 8, 8: 6}
"""Orientations whose turn is undone by another one."""


class Pixels(NamedTuple):
    """Stored pixels, uint8 or uint16: [H, W] grey, [H, W, 3] RGB or [H, W, 4] CMYK; and alpha."""

    colour: NDArray[Any]
    alpha: NDArray[Any] | None

    @property
    def channels(self) -> str:
        """RGB, GRAY or CMYK."""
        return {(): "GRAY", (3,): "RGB", (4,): "CMYK"}[self.colour.shape[2:]]


def read_pixels(image: Image.Image, data: bytes, name: str, upright: bool) -> Pixels:
    """Read the pixels of an open picture; `upright` applies the orientation that EXIF states.

    Pillow reads 16 bits of colour as 8, and some TIFF files wrongly; these go to other decoders.

    Raises:
        InputError: The pixels have no known white.
    """
    deep = read_deep(image, data) if data else None
    if deep is not None:
        return _turn_all(Pixels(*deep), _find_orientation(image) if upright else 1)
    if data and image.format == "TIFF" and _needs_tifffile(image):
        orientation = _find_orientation(image) if upright else 1
        return _turn_all(_read_tiff(data, name), orientation)
    return _from_pillow(image, name, upright)


def _needs_tifffile(image: Image.Image) -> bool:
    tags: Any = image.tag_v2  # type: ignore[attr-defined]
    bits = tags.get(_BITS, (1,))
    if tags.get(_COMPRESSION, 1) in _JPEG_COMPRESSIONS:
        return False
    deep = max(bits) > 8 and set(tags.get(_SAMPLE_FORMAT, (1,))) == {1} and max(bits) <= 16
    planes = tags.get(_PLANES, 1) == 2 and max(bits) == 8
    return (deep or planes) and tags.get(_PHOTOMETRIC) in (
        *(_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _CMYK),
    )


def _read_tiff(data: bytes, name: str) -> Pixels:
    from tifffile import TiffFile

    with TiffFile(BytesIO(data)) as file:
        page: Any = file.pages[0]
        values = np.asarray(page.asarray())
        bits, photometric = int(page.bitspersample), int(page.photometric)
        planar, extra = int(page.planarconfig) == 2, tuple(int(one) for one in page.extrasamples)
        samples = int(page.samplesperpixel)
    if planar and samples > 1:
        values = np.moveaxis(values, 0, -1)
    if values.ndim > 3 or values.dtype not in (np.uint8, np.uint16):
        raise InputError(
            f"{name} is a TIFF file of shape {list(values.shape)} and {values.dtype}, which is not "
            "a photograph; save it as 8-bit or 16-bit RGB."
        )
    if values.dtype == np.uint16 and bits < 16:
        values = (values.astype(np.uint32) * 65535 // (2**bits - 1)).astype(np.uint16)
    if photometric == _WHITE_IS_ZERO:
        values = np.iinfo(values.dtype).max - values
    return _drop_extra_samples(values, photometric, extra)


def _drop_extra_samples(values: NDArray[Any], photometric: int, extra: tuple[int, ...]) -> Pixels:
    """Part colours from alpha, and from samples of another meaning."""
    count = {_RGB: 3, _CMYK: 4}.get(photometric, 1)
    if values.ndim == 2:
        return Pixels(values, None)
    colour, others = values[..., :count], values[..., count:]
    alpha = next((others[..., i] for i, kind in enumerate(extra) if kind in (1, 2)), None)
    if alpha is not None and extra[0] == _ASSOCIATED_ALPHA:
        top = np.iinfo(values.dtype).max
        ratio = top / np.maximum(alpha, 1)[..., None]
        colour = np.minimum(np.rint(colour * ratio), top).astype(values.dtype)
    return Pixels(colour[..., 0] if count == 1 else colour, alpha)


def _from_pillow(image: Image.Image, name: str, upright: bool) -> Pixels:
    stated = _find_orientation(image)
    image.load()
    # Pillow turns TIFF pixels itself, and then no longer states an orientation.
    turned = _find_orientation(image) != stated
    if upright:
        image = _turn_image(image, 1 if turned else stated)
    else:
        image = _turn_image(image, _INVERSE.get(stated, stated) if turned else 1)
    if image.mode.startswith("I;16") or (image.mode == "I" and image.format in ("PNG", "PPM")):
        grey = np.asarray(image).astype(np.uint32).clip(0, 65535)
        return Pixels(grey.astype(np.uint16), None)
    if image.mode not in _EIGHT_BIT:
        raise InputError(
            f"{name} has pixels of Pillow's mode {image.mode}, whose white is not known; "
            "save it as 8-bit or 16-bit sRGB."
        )
    if image.mode in ("P", "PA") and image.palette is None:
        raise ValueError("it has no palette")
    plain = image.convert(_STRAIGHT[image.mode]) if image.mode in _STRAIGHT else image
    alpha = None
    if plain.has_transparency_data:
        alpha = np.array(plain.convert("RGBA").getchannel("A"))
    return Pixels(np.asarray(_drop_alpha(plain)), alpha)


def _find_orientation(image: Image.Image) -> int:
    try:
        return int(image.getexif().get(_ORIENTATION, 1))
    except READ_ERRORS:  # damaged metadata; viewers show such pixels as they are stored
        return 1


def _turn_image(image: Image.Image, orientation: int) -> Image.Image:
    """Turn an image; faster than arrays of three channels."""
    if orientation not in _TRANSPOSES:
        return image
    turned = image.transpose(_TRANSPOSES[orientation])
    turned.format, turned.info = image.format, image.info
    return turned


def _turn_all(pixels: Pixels, orientation: int) -> Pixels:
    return Pixels(
        _turn(pixels.colour, orientation),
        None if pixels.alpha is None else _turn(pixels.alpha, orientation),
    )


def _turn(values: NDArray[Any], orientation: int) -> NDArray[Any]:
    if orientation in (5, 6, 7, 8):
        values = values.swapaxes(0, 1)
    rows = slice(None, None, -1 if orientation in (3, 4, 7, 8) else 1)
    columns = slice(None, None, -1 if orientation in (2, 3, 6, 7) else 1)
    return np.ascontiguousarray(values[rows, columns])


def _drop_alpha(plain: Image.Image) -> Image.Image:
    if plain.mode == "CMYK":
        # Pillow inverts every CMYK JPEG, as Adobe's are; others are not written inverted.
        adobe = plain.format != "JPEG" or "adobe" in plain.info
        return plain if adobe else plain.point(lambda value: 255 - value)
    grey = plain.mode in ("1", "L", "LA") and not isinstance(plain.info.get("transparency"), tuple)
    mode = "L" if grey else "RGB"
    return plain if plain.mode == mode else plain.convert(mode)
