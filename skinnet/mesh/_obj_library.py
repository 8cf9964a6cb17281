"""The materials that an OBJ file uses, from the MTL files that it names."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from skinnet.mesh._foreign_name import describe_absence, find_foreign_file, show_name
from skinnet.mesh._materials import Material, read_materials
from skinnet.mesh._named_file import find_named_file
from skinnet.mesh._obj import ObjFile, Statement

_NONE = frozenset((b"", b"(null)", b"null", b"none", b"off", b"default"))
"""What programs write for faces without a material."""


class Library(NamedTuple):
    """The materials of the `usemtl` lines that have triangles, and what is wrong with them.

    `used` has a place for each statement in the file's `materials`, and one more for triangles
    before the first. `undefined` describes statements that no file defines, `missing` the files
    that are not there.
    """

    used: list[Material | None]
    undefined: list[str]
    missing: list[str]
    notes: list[str]
    names_pictures: bool


def read_library(path: Path, file: ObjFile) -> Library:
    """Read the materials that an OBJ file uses.

    A definition in an earlier file comes before one in a later file. If a file is not there, or
    none is named, the MTL file with the mesh's name is read.

    Raises:
        InputError: If an MTL file cannot be read, or defines a material twice.
    """
    folder = path.absolute().parent
    known: dict[bytes, Material] = {}
    missing: list[str] = []
    notes: list[str] = []
    for statement in file.libraries:
        found, absent = _find_libraries(statement.rest, folder)
        for library in found:
            known = read_materials(library) | known
        missing += [
            f"{show_name(name)} (line {statement.line + 1}), and {describe_absence(name, folder)}"
            for name in absent
        ]
    numbers = [int(each) for each in np.unique(file.material)]
    named = [file.materials[each] for each in numbers if each >= 0]
    if (missing or not file.libraries) and any(_is_undefined(each, known) for each in named):
        known |= _read_beside(path, known, notes)
    used: list[Material | None] = [None] * (len(file.materials) + 1)
    for number in numbers:
        used[number] = _find(known, file.materials[number].rest) if number >= 0 else None
    if not file.materials:
        used[-1] = _take_only(path, known, notes)
    undefined = dict.fromkeys(
        f"{show_name(each.rest)!r} (line {each.line + 1})"
        for each in named
        if _is_undefined(each, known)
    )
    pictures = any(each.pictures for each in known.values()) or len(undefined) > 1
    return Library(used, list(undefined), missing, notes, pictures)


def _find_libraries(names: bytes, folder: Path) -> tuple[list[Path], list[bytes]]:
    """Find the files of one line: the longest runs of its words that are files."""
    found, absent = [], []
    words = names.split()
    while words:
        for length in range(len(words), 0, -1):
            library = find_foreign_file(b" ".join(words[:length]), [folder])
            if library is not None:
                found.append(library.path)
                break
        else:
            ends = (place for place, word in enumerate(words, 1) if word.lower().endswith(b".mtl"))
            length = next(ends, len(words))
            absent.append(b" ".join(words[:length]))
        words = words[length:]
    return found, absent


def _read_beside(
    path: Path, known: dict[bytes, Material], notes: list[str]
) -> dict[bytes, Material]:
    for name in (f"{path.stem}.mtl", f"{path.name}.mtl"):
        found = find_named_file(path.absolute().parent, name)
        if found is not None:
            notes.append(
                f"{path}: materials that are not in files it names are taken from {found.name}, "
                "which has its name."
            )
            return {key: each for key, each in read_materials(found).items() if key not in known}
    return {}


def _take_only(path: Path, known: dict[bytes, Material], notes: list[str]) -> Material | None:
    """Take the only material for a mesh that uses none by name."""
    if len(known) != 1:
        return known.get(b"")
    (only,) = known.values()
    notes.append(
        f"{path} has no usemtl line; {show_name(only.name)!r}, the only material of "
        f"{only.library.name}, is taken."
    )
    return only


def _is_undefined(statement: Statement, known: dict[bytes, Material]) -> bool:
    return _find(known, statement.rest) is None and statement.rest.lower() not in _NONE


def _find(known: dict[bytes, Material], name: bytes) -> Material | None:
    if name in known:
        return known[name]
    alike = [each for key, each in known.items() if _fold(name) & _fold(key)]
    return alike[0] if len(alike) == 1 else None


def _fold(name: bytes) -> set[str]:
    return set(_folded(name))


def _folded(name: bytes) -> Iterator[str]:
    for encoding in ("utf-8", "latin-1"):
        text = name.decode(encoding, "replace")
        yield " ".join(text.split()).casefold()
        yield text.partition(" #")[0].strip().casefold()
