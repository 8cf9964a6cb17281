"""Pictures of one channel that belong to a texture: maps, masks and paint."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.material._texture_file import TextureFile, import_openimageio


def read_plane(path: Path, like: TextureFile) -> NDArray[Any]:
    """Read a picture of one channel at the size of a texture, [height, width].

    Raises:
        InputError: It cannot be read, or is of another size.
    """
    oiio = import_openimageio()
    source = oiio.ImageInput.open(str(path))
    if source is None:
        oiio.geterror()
        raise InputError(f"{path} is not a map that can be read; give a grey PNG of 16 bits.")
    spec = source.spec()
    values = source.read_image(0, 0, 0, 1, str(spec.format))
    source.close()
    if values is None:
        raise InputError(f"{path} is damaged or cut short; make it again.")
    check_size(path, (spec.height, spec.width), like)
    return np.asarray(values)[..., 0]


def check_size(path: Path, shape: tuple[int, ...], like: TextureFile) -> None:
    """Check the size of a picture that is drawn for a texture.

    Raises:
        InputError: It is another one.
    """
    height, width = like.spec.height, like.spec.width
    if shape[:2] != (height, width):
        raise InputError(
            f"{path} is {shape[1]} x {shape[0]} and the texture {width} x {height}; draw it at the "
            "texture's size."
        )
