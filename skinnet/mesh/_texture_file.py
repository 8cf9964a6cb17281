"""Texture files: pictures for meshes, read without applying an EXIF orientation."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.files._reading import read_file
from skinnet.images._decode import decode_file, decode_image
from skinnet.images.picture import Picture

Texture = UInt8[np.ndarray, "_ _ 3"]

_RENDERED = {b"DDS ": "DDS", b"8BPS": "PSD", b"\x01\xda": "SGI"}
_TARGA = b"TRUEVISION-XFILE"
"""The end of a Targa file; older ones are known by their names alone."""


def open_texture(path: Path) -> Picture:
    """Open a picture, its rows and columns as stored in the file.

    Texture coordinates refer to these, so an EXIF orientation is not applied. The format and the
    colour space are decided by the content, as for photographs; Targa, DDS and Photoshop files are
    read too.

    Raises:
        InputError: If the picture is missing, damaged, or larger than `MAX_PIXELS`.
    """
    try:
        data = read_file(path)
    except FileNotFoundError:
        raise InputError(f"There is no texture {path}; check the path.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read as a texture: {error}.") from error
    kind = next((kind for magic, kind in _RENDERED.items() if data.startswith(magic)), None)
    if kind is None and (_TARGA in data[-26:] or path.suffix.lower() == ".tga"):
        kind = "TGA"
    if kind is None:
        return decode_file(BytesIO(data), str(path), upright=False)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(BytesIO(data), formats=[kind])
            return decode_image(image, str(path), data, upright=False)
    except InputError:
        raise
    except (Image.DecompressionBombError, *READ_ERRORS) as error:
        raise InputError(
            f"{path} cannot be read as a texture ({error}); save it as PNG or JPEG."
        ) from error


def describe_texture(picture: Picture) -> list[str]:
    """Describe a picture's colour space if it is not sRGB, and what was assumed of it."""
    space = picture.colour_space
    stated = [] if space.name == "sRGB" else [f"{picture.name} is in {space.name}, "]
    return [each + f"known from {space.known_from}." for each in stated] + list(picture.notes)


def check_colour(texture: Texture, name: str) -> None:
    """Refuse a normal map: its texels are unit vectors, most of them near (0, 0, 1).

    Raises:
        InputError: If it is one.
    """
    step = max(1, int((texture.shape[0] * texture.shape[1] / 250_000) ** 0.5))
    vectors = texture[::step, ::step].reshape(-1, 3) / 127.5 - 1
    used = vectors[(np.ptp(vectors, axis=1) > 0.05) | (np.abs(vectors[:, 0]) < 0.05)]
    if not len(used):
        return
    unit = np.abs(np.linalg.norm(used, axis=1) - 1) < 0.1
    blue = (used[:, 2] > 0.3) & (used[:, 2] > used[:, :2].max(1))
    if (unit & blue).mean() > 0.9:
        raise InputError(
            f"{name} is a normal map by its colours, and not the skin's colour; give the picture "
            "of its colour with --texture."
        )
