"""Pictures from files and from memory, and PNG files."""

import warnings
from dataclasses import replace
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.files._reading import MOST_BYTES, check_length, read_file
from skinnet.images import _decode
from skinnet.images._arguments import check_text
from skinnet.images._array_picture import read_array
from skinnet.images._picture_sources import PictureSource, is_array
from skinnet.images.colour_space import ColourSpace
from skinnet.images.picture import Picture


def read_picture(
    source: PictureSource, name: str | None = None, *, colour_space: str | ColourSpace | None = None
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

    Channels of arrays are last, and those of tensors of torch first; both are red, green, blue:
    BGR, as OpenCV has it, cannot be told from that, so turn it (`array[..., ::-1]`). The white of
    uint8 is 255, of uint16 65535, and of floats 1; floats are kept with 16 bits. Values are sRGB,
    as a file or a screen has them, unless `colour_space` says that they are not.

    Args:
        source: A path; the bytes of a file; an open binary file; a Pillow image; an array [H, W],
            [H, W, 1], [H, W, 3] or [H, W, 4] or a tensor [H, W], [1, H, W], [3, H, W] or
            [4, H, W], of uint8, uint16 or floats in [0, 1]; or a `Picture`, which is returned.
        name: Name of the picture in messages; the path by default.
        colour_space: What the values of an array or a tensor are: "sRGB" (by default), "linear
            sRGB" for linear light, such as that of a renderer, "Display P3", "Adobe RGB (1998)", or
            the `ColourSpace` of another picture. Files and Pillow images state theirs.

    Returns:
        The picture.

    Raises:
        InputError: The source is missing, empty, damaged or not a picture, has more than 100
            megapixels, pixels whose white is not known (floats in a file, PQ, HLG), is of another
            type, shape or range, or could mean several things, such as a tensor [H, W, 3].

    Example:
        >>> from io import BytesIO
        >>> import numpy as np
        >>> from skinnet.images import read_picture
        >>> picture = read_picture(BytesIO(b"P6 2 1 255 " + bytes([255, 0, 0, 0, 0, 255])))
        >>> picture.format, picture.colour_space.name, picture.colour_space.known_from
        ('PPM', 'sRGB', 'assumed')
        >>> grey = np.full((1, 1, 3), 0.2158605)  # linear light
        >>> read_picture(grey, colour_space="linear sRGB").srgb.tolist()
        [[[128, 128, 128]]]
    """
    if name is not None:
        check_text("The name of a picture", name)
    if is_array(source):
        return read_array(source, name or "The array", colour_space)
    if colour_space is not None:
        raise InputError(
            f"colour_space={colour_space!r:.60} is for arrays and tensors; a file or a Pillow "
            "image states its own, or is sRGB."
        )
    if isinstance(source, Picture):
        return source if name in (None, source.name) else replace(source, name=name or source.name)
    if isinstance(source, Image.Image):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return _decode.decode_image(source, name or "The image")
    if isinstance(source, str | PathLike):
        return _from_path(Path(source), name or str(source))
    return _decode.decode_file(BytesIO(_read_bytes(source, name or "The data")), name or "The data")


def read_photo(source: PictureSource, name: str | None = None) -> NDArray[np.uint8]:
    """Read a photograph as upright sRGB without alpha.

    It is `read_picture`, whose transparent pixels are blended with white. Grey pictures are read
    too, but a `Decomposer` refuses them.

    Args:
        source: A path, bytes, an open binary file, a Pillow image, an array, a tensor or a
            `Picture`, as for `read_picture`.
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


def _read_bytes(source: Any, name: str) -> bytes:
    """The bytes of a file, from memory or from an open file."""
    if isinstance(source, bytes | bytearray | memoryview):
        return bytes(source)
    if not hasattr(source, "read"):
        kind = type(source).__name__
        raise InputError(
            "An image is a path, bytes, an open binary file, a Pillow image, an array or a tensor; "
            f"got {kind}."
        )
    try:
        data = source.read(MOST_BYTES + 1)
        at_end = not data and source.seekable() and source.tell() > 0
    except (OSError, ValueError, AttributeError) as error:  # closed, or of text that is no UTF-8
        raise InputError(
            f"The open file cannot be read ({error}); open it in binary, as open(path, 'rb') does."
        ) from error
    if not isinstance(data, bytes | bytearray | memoryview):
        raise InputError(
            f"The open file gives {type(data).__name__} and no bytes; open it in binary, as "
            "open(path, 'rb') does."
        )
    check_length(data, name)
    if at_end:
        raise InputError("The open file has been read to its end before; call its seek(0) first.")
    return bytes(data)
