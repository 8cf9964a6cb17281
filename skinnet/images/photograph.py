"""Pictures from files and from memory, and PNG files."""

import warnings
from io import BufferedIOBase, BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files._reading import read_file, read_stream
from skinnet.images import _decode
from skinnet.images.picture import Picture
from skinnet.images.srgb import to_uint8


def read_picture(
    source: str | Path | BinaryIO | BufferedIOBase | Image.Image | NDArray[Any],
    name: str | None = None,
) -> Picture:
    """Read a picture with everything that its file states.

    One function decides the colour space of every picture: by its profile, the chunks of PNG, the
    boxes of HEIF, AVIF and JPEG 2000, the tags of TIFF and EXIF, in the order of the formats'
    specifications. Without a statement it is sRGB. EXIF orientation is applied, also to a Pillow
    image: remove the tag (as `PIL.ImageOps.exif_transpose` does) if you have turned it yourself. Of
    several frames the first is read.

    A RAW file (DNG, CR3, NEF, ARW, RAF and others) needs the extra `raw`. It becomes sRGB of linear
    light without a tone curve, in the white balance that the camera was set to; the previews in it
    are not read.

    Args:
        source: A path, an open binary file, a Pillow image, or an sRGB array [H, W], [H, W, 1],
            [H, W, 3] or [H, W, 4] of uint8 or of floats in [0, 1].
        name: Name of the picture in messages; the path by default.

    Returns:
        The picture.

    Raises:
        InputError: The source is missing, empty, damaged or not a picture, has more than 100
            megapixels, pixels whose white is not known (floats in a file, PQ, HLG), or is of
            another type, shape or range.

    Example:
        >>> from io import BytesIO
        >>> from skinnet.images import read_picture
        >>> picture = read_picture(BytesIO(b"P6 2 1 255 " + bytes([255, 0, 0, 0, 0, 255])))
        >>> picture.format, picture.colour_space.name, picture.colour_space.known_from
        ('PPM', 'sRGB', 'assumed')
    """
    if isinstance(source, np.ndarray):
        return _from_array(source, name or "The array")
    if isinstance(source, Image.Image):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return _decode.decode_image(source, name or "The image")
    if isinstance(source, str | Path):
        return _from_path(Path(source), name or str(source))
    if not hasattr(source, "read"):
        kind = type(source).__name__
        raise InputError(f"An image is a path, a Pillow image or an array; got {kind}.")
    return _decode.decode_file(BytesIO(read_stream(source, name or "The data")), name or "The data")


def read_photo(
    source: str | Path | BinaryIO | BufferedIOBase | Image.Image | NDArray[Any],
    name: str | None = None,
) -> NDArray[np.uint8]:
    """Read a photograph as upright sRGB without alpha.

    It is `read_picture`, whose transparent pixels are blended with white. Grey pictures are read
    too, but a `Decomposer` refuses them.

    Args:
        source: A path, an open binary file, a Pillow image or an array, as for `read_picture`.
        name: Name of the photograph in error messages; the path by default.

    Returns:
        uint8 sRGB [H, W, 3].

    Raises:
        InputError: As `read_picture`.

    Example:
        >>> from io import BytesIO
        >>> import numpy as np
        >>> from skinnet.images import read_photo
        >>> read_photo(BytesIO(b"P6 2 1 255 " + bytes([255, 0, 0, 0, 0, 255]))).tolist()
        [[[255, 0, 0], [0, 0, 255]]]
        >>> read_photo(np.array([[0.0, 1.0]])).tolist()
        [[[0, 0, 0], [255, 255, 255]]]
    """
    return _make_writable(read_picture(source, name).srgb)


def _make_writable(srgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return srgb if srgb.flags.writeable else srgb.copy()


def _from_path(path: Path, name: str) -> Picture:
    if path.is_dir():
        raise InputError(f"{path} is a folder; give a photograph in it.")
    try:
        return _decode.decode_file(BytesIO(read_file(path)), name)
    except FileNotFoundError:
        raise InputError(f"There is no file {path}; check the path.") from None
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path} cannot be read: {error}.") from error


def _from_array(array: NDArray[Any], name: str) -> Picture:
    grey = array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 1)
    if (not grey and not (array.ndim == 3 and array.shape[2] in (3, 4))) or array.size == 0:
        raise InputError(
            f"A photograph is [H, W], [H, W, 3] or [H, W, 4]; got shape {list(array.shape)}."
        )
    _decode.check_size(array.shape[1], array.shape[0], name)
    value = array if array.dtype == np.uint8 else to_uint8(_check_floats(array))
    colour = value.reshape(value.shape[:2]) if grey else value[..., :3]
    return Picture(
        name, np.array(colour), value[..., 3].copy() if array.shape[2:] == (4,) else None
    )


def _check_floats(array: NDArray[Any]) -> NDArray[np.float32]:
    if not np.issubdtype(array.dtype, np.floating):
        raise InputError(
            f"A photograph is uint8 or floats in [0, 1]; got {array.dtype}. "
            "Divide it by its white first."
        )
    outside = array[~((array >= 0) & (array <= 1))]
    if outside.size:
        raise InputError(
            f"A photograph of floats lies in [0, 1]; got {outside[0]:g}. "
            "Divide it by 255 if it was read from a file."
        )
    return array.astype(np.float32)
