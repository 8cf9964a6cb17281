"""Texture files: pictures for meshes, read without applying an EXIF orientation."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._decode import MAX_PIXELS, PHOTO_FORMATS, PHOTO_SUFFIXES, to_srgb

Texture = UInt8[np.ndarray, "_ _ 3"]


def read_texture(path: Path) -> Texture:
    """Read a picture as uint8 sRGB, its rows and columns as stored in the file.

    Texture coordinates refer to these, so an EXIF orientation is not applied. Colour profiles are,
    and transparency is composited on white.

    Raises:
        InputError: If the picture is missing, damaged, or larger than `MAX_PIXELS`.
    """
    Image.init()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(
                path, formats=[known for known in PHOTO_FORMATS if known in Image.OPEN]
            )
    except FileNotFoundError:
        raise InputError(f"There is no texture {path}; check the path.") from None
    except (Image.DecompressionBombError, *READ_ERRORS) as error:
        raise InputError(f"{path} is not a picture that can be read as a texture.") from error
    with image:
        return decode_texture(image, str(path))


def decode_texture(image: Image.Image, name: str) -> Texture:
    """Decode an open image as uint8 sRGB; errors call it `name`."""
    width, height = image.size
    if width * height > MAX_PIXELS:
        raise InputError(
            f"{name} is {width} x {height} pixels, more than {MAX_PIXELS:,}; scale it down first."
        )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image.load()
            return np.array(to_srgb(image, name))
    except InputError:
        raise
    except (Image.DecompressionBombError, *READ_ERRORS) as error:
        raise InputError(f"{name} is damaged or cut short ({error}); copy it again.") from error


def find_texture_beside(path: Path) -> Path | None:
    """Find the picture with the mesh's name in its folder, else the only picture there."""
    pictures = sorted(
        p for p in path.absolute().parent.iterdir() if p.suffix.lower() in PHOTO_SUFFIXES
    )
    named = [picture for picture in pictures if picture.stem == path.stem]
    if len(named) == 1:
        return named[0]
    return pictures[0] if len(pictures) == 1 else None
