"""Files that are written completely or not at all."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex

from skinnet.errors import InputError


@contextmanager
def write_together() -> Iterator[Callable[[Path], Path]]:
    """Write several files, all of them or none.

    Yields:
        A function from the path of a file to the temporary path to write it to, in the same folder.
        At the end all temporary files are renamed. If an error is raised before or then, none of
        the new files is left, and older files of these names stay.

    Raises:
        InputError: A folder has the name of one of the files.

    Example:
        >>> from tempfile import mkdtemp
        >>> folder = Path(mkdtemp())
        >>> with write_together() as temporary:
        ...     _ = temporary(folder / "a.txt").write_text("a")
        ...     _ = temporary(folder / "b.txt").write_text("b")
        >>> sorted(path.name for path in folder.iterdir())
        ['a.txt', 'b.txt']
    """
    parts: dict[Path, Path] = {}

    def name_temporary(path: Path) -> Path:
        if path.is_dir():
            raise InputError(f"{path} is a folder, but a file of that name must be written.")
        return parts.setdefault(path, path.with_name(f".{token_hex(6)}.part{path.suffix}"))

    renamed: list[Path] = []
    older: dict[Path, Path] = {}
    try:
        yield name_temporary
        for path, part in parts.items():
            _keep_older(path, older)
            os.replace(part, path)
            renamed.append(path)
    except BaseException:
        for path in (*renamed, *parts.values()):
            path.unlink(missing_ok=True)
        for path, kept in older.items():
            os.replace(kept, path)
            kept.unlink(missing_ok=True)  # it stays where both are names of one file
        raise
    for kept in older.values():
        kept.unlink(missing_ok=True)


def _keep_older(path: Path, older: dict[Path, Path]) -> None:
    """Give a file that is about to be replaced a second name, until all have been written."""
    kept = path.with_name(f".{token_hex(6)}.old{path.suffix}")
    with suppress(OSError, NotImplementedError):  # there is none, or links are unknown
        os.link(path, kept, follow_symlinks=False)
        older[path] = kept


@contextmanager
def write_atomically(path: Path) -> Iterator[Path]:
    """Write a file completely or not at all.

    Args:
        path: The file to write.

    Yields:
        The temporary path to write to, in the same folder. At the end it is renamed to `path`; if
        an error is raised before, it is removed, and an older file at `path` stays.

    Raises:
        InputError: `path` is a folder.

    Example:
        >>> from tempfile import mkdtemp
        >>> folder = Path(mkdtemp())
        >>> with write_atomically(folder / "a.txt") as temporary:
        ...     _ = temporary.write_text("a")
        >>> [path.name for path in folder.iterdir()]
        ['a.txt']
    """
    with write_together() as name_temporary:
        yield name_temporary(path)


def make_folder(folder: Path, remedy: str) -> Path:
    """Make a folder and its parents where they do not exist.

    Args:
        folder: The folder to make.
        remedy: What to do if it cannot be made; the end of the error message.

    Returns:
        `folder` itself.

    Raises:
        InputError: The folder cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made ({error.strerror}); {remedy}.") from error
    return folder


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8, completely or not at all.

    Args:
        path: The file to write.
        text: Its content.

    Raises:
        InputError: `path` is a folder.
    """
    with write_atomically(path) as part:
        part.write_text(text, encoding="utf-8")
