"""The file of one person's maps: NAME_maps.npz."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.appearance import _array_file
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture

_KIND = "SkinTexture"
_ARRAYS = ("f_mel", "f_blood", "offset", "mask")


def save_maps(
    path: Path,
    texture: SkinTexture,
    colour: SkinColour,
    origin: Mapping[str, Any] | None = None,
) -> None:
    """Write one person's maps to a .npz file, all of it or nothing.

    Args:
        path: NAME_maps.npz.
        texture: The maps.
        colour: Light, camera and calibration under which they were inverted.
        origin: What the file states of its origin, in primitives: `mark` and `input` of a command.

    Raises:
        InputError: If the path does not end in .npz or cannot be written.

    Example:
        >>> import tempfile
        >>> level, known = np.full((2, 2), 0.04, np.float32), np.ones((2, 2), bool)
        >>> face = SkinTexture(level, level, np.zeros((2, 2, 3), np.float32), known)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     save_maps(Path(folder, "a_maps.npz"), face, SkinColour(nodes=(4, 4)))
        ...     texture, colour = load_maps(Path(folder, "a_maps.npz"))
        >>> bool((texture.f_mel == level).all()), colour.light
        (True, 'D65')
    """
    arrays = {name: getattr(texture, name) for name in _ARRAYS}
    header = {"name": texture.name, "colour": colour.to_record(), **(origin or {})}
    _array_file.write_arrays(path, _KIND, header, arrays)


def load_maps(path: Path) -> tuple[SkinTexture, SkinColour]:
    """Read one person's maps that `save_maps` wrote; see there for an example.

    Args:
        path: NAME_maps.npz.

    Returns:
        The maps, and the light, camera and calibration under which they were inverted.

    Raises:
        InputError: If the file is missing, damaged or of another kind.
    """
    header, arrays = _array_file.read_arrays(path, _KIND, _ARRAYS)
    try:
        colour = SkinColour.from_record(header["colour"])
        f_mel, f_blood, offset = (np.asarray(arrays[name], np.float32) for name in _ARRAYS[:3])
        mask = arrays["mask"]
        square = (len(mask), len(mask))
        shapes = [part.shape for part in (f_mel, f_blood, offset, mask)]
        if shapes != [square, square, (*square, 3), square]:
            raise _array_file.make_damage_error(path)
        return SkinTexture(f_mel, f_blood, offset, mask.astype(bool), str(path)), colour
    except _array_file.ARCHIVE_ERRORS as error:
        raise _array_file.make_damage_error(path) from error
