"""Reading of files: regular ones only, and never more than fits."""

import os
import stat
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedIOBase, BufferedReader
from pathlib import Path
from typing import BinaryIO

from skinnet.errors import InputError

MOST_BYTES = 1_000_000_000
"""Largest file that is read into memory: more than any picture that is decoded, or any scan."""

MOST_TEXT = 10_000_000
"""Largest file of settings, landmarks or records."""

READ_ERRORS = (
    *(OSError, SyntaxError, ValueError, EOFError, TypeError, RuntimeError, MemoryError),
    *(ArithmeticError, LookupError, AttributeError, AssertionError, struct.error, zlib.error),
)
"""What readers of pictures, meshes and arrays raise on damaged files."""


@contextmanager
def open_file(path: str | Path) -> Iterator[BufferedReader]:
    """Open a regular file.

    Raises:
        InputError: It is a pipe, a socket or a device, which would wait for its writer or never
            end.
        OSError: As `open`.
    """
    # Without O_NONBLOCK a pipe would wait here, until somebody writes into it.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(path, "rb", opener=lambda name, _: os.open(name, flags)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise InputError(
                f"{path} is a pipe, socket or device, and a file is needed; write its content to a "
                "file first, and give that."
            )
        yield file


def read_file(path: str | Path, most: int = MOST_BYTES) -> bytes:
    """Read a regular file that is not larger than a limit.

    Args:
        path: The file.
        most: The limit, in bytes.

    Raises:
        InputError: It is larger, or no file.
        OSError: As `open`.
    """
    with open_file(path) as file:
        if os.fstat(file.fileno()).st_size > most:
            raise _too_large(str(path), most)
        return file.read()


def read_stream(stream: BinaryIO | BufferedIOBase, name: str, most: int = MOST_BYTES) -> bytes:
    """Read a stream to its end, which must come within a limit.

    Args:
        stream: A binary stream, such as standard input.
        name: Its name in messages.
        most: The limit, in bytes.

    Raises:
        InputError: There is more, or the stream cannot be read.
    """
    try:
        data = stream.read(most + 1)
    except OSError as error:
        raise InputError(f"{name} cannot be read ({error.strerror}); give a file.") from error
    check_length(data, name, most)
    return data


def check_length(data: bytes | bytearray | memoryview, name: str, most: int = MOST_BYTES) -> None:
    """Raise `InputError` for more bytes than a limit."""
    if len(data) > most:
        raise _too_large(name, most)


def _too_large(name: str, most: int) -> InputError:
    size = f"{most // 1_000_000:,} MB"
    return InputError(f"{name} is larger than the limit of {size}; give a smaller file.")
