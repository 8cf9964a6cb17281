"""Files that appear whole or not at all."""

import os
import struct
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from skinnet.errors import InputError

BROKEN = (
    *(OSError, SyntaxError, ValueError, EOFError, TypeError, RuntimeError, MemoryError),
    *(ArithmeticError, LookupError, AttributeError, struct.error, zlib.error),
)
"""What readers of pictures, meshes and arrays raise on damaged files."""


@contextmanager
def written_together() -> Iterator[Callable[[Path], Path]]:
    """Hand out a temporary name for each file to write; rename all of them on leaving.

    The names lie beside the files, on the same disk. If the body or a renaming raises, none of the
    new files is left. Raises `InputError` where a folder already has a file's name.
    """
    parts: dict[Path, Path] = {}

    def beside(path: Path) -> Path:
        if path.is_dir():
            raise InputError(f"{path} is a folder, and a file of that name is to be written.")
        return parts.setdefault(path, path.with_name(f".{token_hex(6)}.part{path.suffix}"))

    placed: list[Path] = []
    try:
        yield beside
        for path, part in parts.items():
            os.replace(part, path)
            placed.append(path)
    except BaseException:
        for path in (*placed, *parts.values()):
            path.unlink(missing_ok=True)
        raise


@contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """A temporary name beside `path` that takes its place on leaving, or is removed on an error."""
    with written_together() as beside:
        yield beside(path)


def made(folder: Path, remedy: str) -> Path:
    """The folder, made if needed; `InputError` with the remedy if it cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made ({error.strerror}); {remedy}.") from error
    return folder


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text atomically."""
    with atomic(path) as part:
        part.write_text(text, encoding="utf-8")
