"""Names of files as programs and machines of every kind write them."""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from skinnet.mesh._named_file import find_named_file, is_inside

_ENCODINGS = ("utf-8", "cp1252", "latin-1", "gb18030", "shift_jis", "cp1251", "cp850")
_ROOT = re.compile(r"^(?:file:)?/*(?:[a-zA-Z]:)?/*")


class FoundFile(NamedTuple):
    """A file that was found, and whether in another folder than its name says."""

    path: Path
    moved: bool


def find_foreign_file(
    name: bytes, folders: list[Path], root: Path | None = None
) -> FoundFile | None:
    """Find the file of a name, in the first of some folders in which it is.

    Nothing outside of `root` is opened, by default each folder itself.

    The name may be quoted, percent-encoded, in any usual encoding, with back-slashes, or in another
    case than the file's. If it has folders that are not there, as the path of another machine has,
    ever shorter ends of it are tried.
    """
    spellings = list(dict.fromkeys(_spell(name)))
    for spelling in spellings:
        for folder in folders:
            found = find_named_file(folder, spelling, root)
            if found is not None:
                return FoundFile(found, False)
    for spelling in spellings:
        parts = [part for part in _ROOT.sub("", spelling.replace("\\", "/")).split("/") if part]
        for start in range(len(parts)):
            for folder in folders:
                found = find_named_file(folder, "/".join(parts[start:]), root)
                if found is not None:
                    return FoundFile(found, True)
    return None


def describe_absence(name: bytes, folder: Path) -> str:
    """Say why no file of a name was found for a mesh or material in a folder."""
    path = show_name(name).strip("\"' ").removeprefix("file://").replace("\\", "/")
    if is_inside(folder, folder, path):
        return "there is no such file"
    return "files outside of the mesh's folder are not opened by their names"


def show_name(name: bytes) -> str:
    """Show a name as it is written, as far as its encoding is known."""
    shown = next(_decode(name, 1))
    return shown if len(shown) <= 200 else f"{shown[:200]}..."


def _spell(name: bytes) -> Iterator[str]:
    """List what a name may mean, the most literal first."""
    for text in (os.fsdecode(name), *_decode(name, len(_ENCODINGS))):
        bare = text.strip()
        yield bare
        yield bare.strip("\"'").strip()
        yield re.sub(r"\s+#.*$", "", bare).strip("\"'")


def _decode(name: bytes, most: int) -> Iterator[str]:
    """Decode as UTF-8, else in other encodings."""
    try:
        yield name.decode()
    except UnicodeDecodeError:
        for encoding in _ENCODINGS[1:][:most]:
            yield name.decode(encoding, "replace")
