"""Files that other files name: percent-encoded, with back-slashes, or in another case."""

import os
import unicodedata
from pathlib import Path
from urllib.parse import unquote


def find_named_file(folder: Path, name: str, root: Path | None = None) -> Path | None:
    """Find the file that a mesh or material in `folder` names, or None.

    The name is tried as it is written, then percent-decoded and with back-slashes as separators.
    Where no file has exactly this name, the only one that differs in case or in Unicode
    normalisation is taken. A mesh may come from anybody: paths that lead out of `root`, by default
    `folder`, are not followed.
    """
    root = root or folder
    plain = name.split("?")[0].split("#")[0]
    spellings = [name, unquote(name), plain, unquote(plain)]
    paths = dict.fromkeys(
        spelling.removeprefix("file://").strip()
        for one in spellings
        for spelling in (one, one.replace("\\", "/"))
    )
    for find in (_find_exactly, _find_in_any_case):
        for path in paths:
            found = find(folder, path) if is_inside(root, folder, path) else None
            if found is not None:
                return found
    return None


def is_inside(root: Path, folder: Path, path: str) -> bool:
    """Whether a path that is written in a file of `folder` stays below `root`."""
    top = os.path.abspath(root)
    whole = os.path.abspath(os.path.join(folder, path)) if "\0" not in path else ""
    return whole.startswith(os.path.join(top, ""))


def _find_exactly(folder: Path, path: str) -> Path | None:
    return folder / path if path and _exists(folder / path) else None


def _find_in_any_case(folder: Path, path: str) -> Path | None:
    named = Path(path)
    found = Path(named.anchor) if named.anchor else folder
    for part in named.parts[1:] if named.anchor else named.parts:
        step = _match(found, part)
        if step is None:
            return None
        found = step
    return found if path and _exists(found) else None


def _match(folder: Path, part: str) -> Path | None:
    """Match one part of a path: as it is written, else the only one that differs in case."""
    try:
        if part == ".." or (folder / part).exists():
            return folder / part
        same = [each for each in folder.iterdir() if _fold(each.name) == _fold(part)]
    except (OSError, ValueError):  # no folder, or a name that is too long or has a zero byte
        return None
    return same[0] if len(same) == 1 else None


def _exists(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _fold(name: str) -> str:
    return unicodedata.normalize("NFC", name).casefold()
