"""The names of results: a number is added where another input's results or a user's files lie."""

import hashlib
import os
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.files._reading import open_file

OUTPUT = "skinmaps"
"""Folder beside a photograph or a scan for its results."""

Belongs = Callable[[Path], bool]
"""Whether an existing file is a result of the same input, so that it may be replaced."""


def choose_stem(folder: Path, stem: str, ends: Iterable[str], belongs: Belongs) -> str:
    """Choose how the names of an input's results begin.

    Args:
        folder: Where the results are written; it need not exist.
        stem: The name that they have without a number, such as `photo`.
        ends: Ends of all names, such as `.json` and `_panel.png`.
        belongs: Whether an existing file is an earlier result of the same input.

    Returns:
        The first of STEM, STEM-2, STEM-3 and so on under which no file of another input and no
        file of the user lies, in any spelling that a file system may take for the same.
    """
    names = _list_names(folder)
    ends = tuple(ends)
    number, chosen = 1, stem
    while not all(
        belongs(folder / name) for end in ends for name in names.get(_fold(chosen + end), ())
    ):
        number += 1
        chosen = f"{stem}-{number}"
    return chosen


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Keep other processes from choosing names in a folder, where the system has such locks."""
    try:
        import fcntl

        descriptor = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):  # Windows; writing says what is wrong with the folder
        yield
        return
    try:
        with suppress(OSError):  # some network file systems have no locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def compute_digest(path: Path) -> str:
    """Compute the SHA-256 of a file, in hexadecimals.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        with open_file(path) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); check the path.") from error


def describe_input(path: Path | None, digest: str, folder: Path) -> dict[str, str | None]:
    """Describe an input for the summary of its results.

    Args:
        path: The input file; None for standard input.
        digest: Its SHA-256.
        folder: Folder of the summary; the path is relative to it where that is possible.

    Returns:
        `path` and `sha256`.
    """
    if path is None:
        return {"path": None, "sha256": digest}
    whole = os.path.abspath(path)
    try:
        whole = os.path.relpath(whole, os.path.realpath(folder))
    except ValueError:  # another drive of Windows
        pass
    return {"path": Path(whole).as_posix(), "sha256": digest}


def is_input(record: Mapping[str, Any], path: Path | None, digest: str, folder: Path) -> bool:
    """Whether a record of `describe_input` in a folder describes this input.

    Path and content have to be the same. A file that has been moved since is known by its content.
    """
    if record.get("sha256") != digest:
        return False
    known = record.get("path")
    if path is None or not isinstance(known, str):
        return path is None and known is None
    there = folder / known
    return not there.exists() or os.path.realpath(there) == os.path.realpath(path)


def _list_names(folder: Path) -> dict[str, list[str]]:
    names: dict[str, list[str]] = {}
    if folder.is_dir():
        for name in os.listdir(folder):
            names.setdefault(_fold(name), []).append(name)
    return names


def _fold(name: str) -> str:
    """A spelling that is the same for names that some file systems hold for one."""
    if name.isascii():  # a folder may hold a hundred thousand
        return name.lower()
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())
