"""Texture files: pictures for meshes, read without applying an EXIF orientation."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from skinnet.errors import InputError
from skinnet.images._decode import PHOTO_SUFFIXES, decode_file, decode_image

Texture = UInt8[np.ndarray, "_ _ 3"]


def read_texture(path: Path) -> Texture:
    """Read a picture as uint8 sRGB, its rows and columns as stored in the file.

    Texture coordinates refer to these, so an EXIF orientation is not applied. The colour space is
    decided as for photographs, and transparency is composited on white.

    Raises:
        InputError: If the picture is missing, damaged, or larger than `MAX_PIXELS`.
    """
    try:
        with path.open("rb") as file:
            return decode_file(file, str(path), upright=False).srgb
    except FileNotFoundError:
        raise InputError(f"There is no texture {path}; check the path.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read as a texture: {error}.") from error


def decode_texture(image: Image.Image, name: str) -> Texture:
    """Decode an open image as uint8 sRGB; errors call it `name`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return decode_image(image, name, upright=False).srgb


def find_texture_beside(path: Path) -> Path | None:
    """Find the picture with the mesh's name in its folder, else the only picture there."""
    pictures = sorted(
        p for p in path.absolute().parent.iterdir() if p.suffix.lower() in PHOTO_SUFFIXES
    )
    named = [picture for picture in pictures if picture.stem == path.stem]
    if len(named) == 1:
        return named[0]
    return pictures[0] if len(pictures) == 1 else None
