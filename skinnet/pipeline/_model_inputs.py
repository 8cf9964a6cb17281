"""The subjects of a model: their maps, a drawn mask, and their shapes."""

from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from skinnet.appearance.maps_file import load_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError
from skinnet.images.photograph import read_photo
from skinnet.inference._messages import log
from skinnet.pipeline._fit_archive import load_fit
from skinnet.pipeline._output import MAPS_END
from skinnet.pipeline._progress import compute_fingerprint
from skinnet.pipeline._source import read_result_mark


def find_maps(places: list[Path]) -> list[Path]:
    """List the given files of maps, and those in the given folders."""
    files: list[Path] = []
    for place in places:
        if not place.exists():
            raise InputError(f"There is no {place}; name *{MAPS_END} files or a folder of them.")
        inside = sorted(place.glob(f"*{MAPS_END}")) if place.is_dir() else [place]
        inside = [file for file in inside if not place.is_dir() or not _is_made_up(file)]
        if not inside:
            raise InputError(
                f"The folder {place} holds no *{MAPS_END}; make them with skinnet maps."
            )
        files += [file for file in inside if file not in files]
    if len(files) < 3:
        raise InputError(
            f"{len(files)} subjects were found, and a model that can be measured needs three; "
            f"name more *{MAPS_END}."
        )
    return files


def _is_made_up(file: Path) -> bool:
    """Tell whether maps were made by edit-maps or sample; such a face is not another subject."""
    mark = read_result_mark(file)
    verb = mark.verb if mark else ""
    edited = verb == "edit-maps" or file.name.endswith(f"_edited{MAPS_END}")
    if edited or verb == "sample":
        log(f"{file} is {'an edited' if edited else 'a random'} face and is left out.")
    return edited or verb == "sample"


def stack_subjects(files: list[Path], folder: Path) -> SubjectStack:
    """Write the subjects into one stack on disk; an interrupted run is resumed."""
    colours = {file: load_maps(file)[1].to_record() for file in files}
    first = colours[files[0]]
    for file, colour in colours.items():
        if colour != first:
            raise InputError(
                f"{file} was inverted under another light, camera or calibration than {files[0]}; "
                "invert all together with one skinnet maps."
            )
    subjects = {str(file): partial(_read_texture, file) for file in files}
    return write_stack(folder, subjects, load_maps(files[0])[1], compute_fingerprint(*files))


def _read_texture(file: Path) -> SkinTexture:
    log(f"{file} is read.")
    return load_maps(file)[0]


def read_mask(path: Path | None, size: int) -> Bool[np.ndarray, "size size"] | None:
    """Read a drawn mask, True where the picture is lighter than middle grey."""
    if path is None:
        return None
    drawn = np.asarray(read_photo(path).mean(-1) > 127)
    if drawn.shape != (size, size):
        raise InputError(
            f"{path} is {drawn.shape[1]} x {drawn.shape[0]} pixels and the maps are {size} x "
            f"{size}; draw the mask at their size."
        )
    return drawn


def read_shape(maps: Path, modes: int) -> Float[np.ndarray, "modes"]:
    """Read the shape coefficients of the fit that belongs to a file of maps."""
    alpha = load_fit(maps.with_name(maps.name.removesuffix(MAPS_END) + "_shape.npz")).alpha
    if len(alpha) > modes:
        raise InputError(
            f"The shape beside {maps} has {len(alpha)} coefficients and the shape model {modes}; "
            "give the shape model that it was fitted with."
        )
    return np.pad(alpha, (0, modes - len(alpha)))
