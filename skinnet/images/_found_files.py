"""Files that a walk meets: what they are, whether two names are one file, what is litter."""

import glob
import os
import stat
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path

from skinnet.images._kind import OTHER, Kind, identify, is_readable, promises_picture
from skinnet.images._mark import read_mark, read_summary

SPECIAL = Kind("a pipe, socket or device", "pipes, sockets or devices", "give a file")
BROKEN_LINK = Kind("a broken link", "broken links", "repair or remove it")

NOT_DOWNLOADED = Kind(
    "a file that is only in iCloud", "files that are only in iCloud", "download it"
)

_LITTER = frozenset(
    (
        *("thumbs.db", "ehthumbs.db", "desktop.ini", "icon\r", "__macosx", "@eadir", "#recycle"),
        *("$recycle.bin", "system volume information", "lost+found"),
    )
)
"""Files and folders that file managers leave behind, with thumbnails of photographs in some."""

_MOST_COUNTED = 1000


def look_at(path: str) -> Kind | None:
    """Find the kind of a file; None if it promises a picture and may not be opened."""
    if is_placeholder(os.path.basename(path)):
        return NOT_DOWNLOADED
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            return SPECIAL
        with open(path, "rb") as file:
            return identify(file, path)
    except OSError as error:
        if os.path.islink(path) and not os.path.exists(path):
            return BROKEN_LINK
        return None if promises_picture(path, OTHER) else _name_fault(error)


def get_identity(path: str | Path) -> object:
    """What all names of a file share: its number on its device, or its real path."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return os.path.abspath(path)
    if status.st_ino:
        return status.st_dev, status.st_ino
    return os.path.normcase(os.path.realpath(path))


def is_litter(name: str) -> bool:
    """Whether a name is hidden, or one that file managers leave behind."""
    if is_placeholder(name):
        return False
    return name.startswith(".") or name.casefold() in _LITTER


def is_placeholder(name: str) -> bool:
    """Whether macOS has left a file of this name for one that is only in iCloud."""
    return name.startswith(".") and name.endswith(".icloud")


def is_summary(path: str) -> bool:
    """Whether a file is a summary that skinnet wrote."""
    return path.lower().endswith(".json") and read_summary(Path(path)) is not None


def count_below(folders: Iterable[Path]) -> tuple[int, int, bool]:
    """Count the photographs in subfolders: photographs, folders with some, and whether that is all.

    No more than a thousand files are looked at.
    """
    found: dict[str, int] = {}
    files = _list_files(folders)
    for place, name in islice(files, _MOST_COUNTED):
        if _is_photograph(os.path.join(place, name)):
            found[place] = found.get(place, 0) + 1
    return sum(found.values()), len(found), next(files, None) is None


def describe_link(path: str) -> str:
    """Say of a broken link where it leads."""
    return f"{path} is a link to {os.readlink(path)}, which cannot be reached; repair or remove it."


def escape_existing(pattern: str) -> str:
    """Take the first parts of a pattern as they are if they exist, such as a folder photos[1]."""
    parts = Path(pattern).parts
    whole, escaped = "", list[str]()
    for number, part in enumerate(parts):
        whole = os.path.join(whole, part)
        if not os.path.lexists(whole):
            return os.path.join(*escaped, *parts[number:])
        escaped.append(glob.escape(part))
    return os.path.join(*escaped)


def _list_files(folders: Iterable[Path]) -> Iterator[tuple[str, str]]:
    for folder in folders:
        for place, names, files in os.walk(folder):
            names[:] = sorted(name for name in names if not is_litter(name))
            yield from ((place, name) for name in files if not is_litter(name))


def _is_photograph(path: str) -> bool:
    kind = look_at(path)
    return kind is not None and is_readable(kind) and read_mark(path) is None


def _name_fault(error: OSError) -> Kind:
    reason = (error.strerror or "an error of the system").lower()
    return Kind(f"a file that cannot be opened ({reason})", f"files not to be opened ({reason})")
