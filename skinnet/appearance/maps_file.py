"""The file of one person's maps: NAME_maps.npz."""

from pathlib import Path

import numpy as np

from skinnet.appearance import _model_arrays
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture

KIND = "SkinTexture"
_ARRAYS = ("f_mel", "f_blood", "offset", "mask")


def save_maps(path: Path, texture: SkinTexture, colour: SkinColour) -> None:
    """Write maps and the colours under which they were found, whole or not at all."""
    arrays = {name: getattr(texture, name) for name in _ARRAYS}
    header = {"name": texture.name, "colour": colour.to_record()}
    _model_arrays.write_arrays(path, KIND, header, arrays)


def load_maps(path: Path) -> tuple[SkinTexture, SkinColour]:
    """Read maps. Raises `InputError` for a file that is missing, damaged or something else."""
    header, arrays = _model_arrays.read_arrays(path, KIND, _ARRAYS)
    try:
        colour = SkinColour.from_record(header["colour"])
        f_mel, f_blood, offset = (np.asarray(arrays[name], np.float32) for name in _ARRAYS[:3])
        mask = arrays["mask"]
        square = (len(mask), len(mask))
        shapes = [part.shape for part in (f_mel, f_blood, offset, mask)]
        if shapes != [square, square, (*square, 3), square]:
            raise _model_arrays.make_damage_error(path)
        return SkinTexture(f_mel, f_blood, offset, mask.astype(bool), str(path)), colour
    except _model_arrays.READ_ERRORS as error:
        raise _model_arrays.make_damage_error(path) from error
