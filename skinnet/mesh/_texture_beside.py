"""The picture beside a mesh that names none."""

import re
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from skinnet.images._found_files import is_litter
from skinnet.images._kind import PICTURE, identify
from skinnet.images._mark import read_mark
from skinnet.mesh._mesh_parts import MESH_SUFFIXES

_COLOUR = frozenset(
    "albedo basecolor basecolour base color colour col diffuse diff texture tex".split()
)
_OTHER = frozenset(
    "normal normals norm nrm nor bump height displacement disp roughness rough specular spec gloss "
    "glossiness metallic metalness metal ao occlusion ambientocclusion cavity curvature opacity "
    "alpha mask emissive emission translucency sss scatter thickness position preview thumbnail "
    "thumb screenshot render melanin hemoglobin panel maps edited".split()
)

_MOST = 500
"""In a folder of more files, a picture is taken by the mesh's name only."""


class PictureBeside(NamedTuple):
    """The picture that is taken, if any, and a sentence that says why."""

    path: Path | None
    note: str


def find_texture_beside(path: Path) -> PictureBeside:
    """Find a picture for a mesh that names none: by the mesh's name, or by a name of colour.

    The name of the picture is that of the mesh, perhaps with a word for colour (`head_albedo`); or
    it says that it is colour (`albedo.jpg`), and there is no other picture and no other mesh in the
    folder. Names of normals, roughness and the like are never taken.
    """
    folder = path.absolute().parent
    files = sorted(each for each in folder.iterdir() if each.is_file())
    stem = path.stem.casefold()
    same = [each for each in files if each.stem.casefold() == stem and is_picture(each)]
    more = [each for each in files if _is_colour_of(each.stem.casefold(), stem)]
    for found in (same, [each for each in more if is_picture(each)]):
        if len(found) == 1:
            return PictureBeside(found[0], f"{path} names no picture; {found[0].name} is taken.")
    pictures = list(islice((each for each in files[:_MOST] if is_picture(each)), 4))
    meshes = [each for each in files if each.suffix.lower() in MESH_SUFFIXES]
    alone = len(pictures) == len(meshes) == 1 and len(files) <= _MOST
    if alone and not same and _says_colour(pictures[0].stem):
        note = f"{path} names no picture; {pictures[0].name}, the only one beside it, is taken."
        return PictureBeside(pictures[0], note)
    names = ", ".join(each.name for each in pictures)
    seen = f"; of {names} beside it none is sure to be its colour" if names else ""
    return PictureBeside(
        None,
        f"{path} has texture coordinates and names no picture{seen}. Give the texture with "
        "--texture.",
    )


def is_picture(path: Path) -> bool:
    """Whether a file is a picture by its content, and none that skinnet wrote."""
    try:
        with path.open("rb") as file:
            found = not is_litter(path.name) and identify(file, path.name) is PICTURE
        return found and read_mark(path) is None
    except OSError:
        return False


def _is_colour_of(stem: str, mesh: str) -> bool:
    rest = stem.removeprefix(mesh)
    return stem.startswith(mesh) and bool(re.match(r"[\W_]", rest)) and _says_colour(rest)


def _says_colour(stem: str) -> bool:
    """Whether a word of a name means colour, and none another map."""
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", stem)
    words = set(re.split(r"[\W_\d]+", f"{spaced} {stem}".lower()))
    return bool(words & _COLOUR) and not words & _OTHER
