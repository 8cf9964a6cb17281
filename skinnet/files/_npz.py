"""Archives of arrays, whose sizes are known before anything of them is read."""

import math
import os
import tokenize
import zipfile
import zlib
from collections.abc import Collection
from io import BufferedIOBase
from pathlib import Path
from typing import Any

from numpy.lib import format as npy
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files._reading import open_file

_ALWAYS, _RATIO, _MOST = 100_000_000, 50, 8_000_000_000
"""Bytes that any file may hold, bytes for each of its own, and bytes that no file may hold."""

_DAMAGES = (
    *(zipfile.BadZipFile, zlib.error, tokenize.TokenError, SyntaxError, EOFError),
    *(NotImplementedError, RuntimeError, OverflowError, TypeError, UnicodeError, AttributeError),
)
"""What zipfile and NumPy raise on damaged archives, apart from `ValueError`."""


def read_npz(path: Path, names: Collection[str] | None = None) -> dict[str, NDArray[Any]]:
    """Read arrays of an .npz file.

    Args:
        path: The file.
        names: Names of the arrays; None for all.

    Returns:
        The arrays by name.

    Raises:
        InputError: The arrays would be far larger than the file, or than any model.
        KeyError: An array is missing.
        ValueError: The file is damaged, no archive of arrays, or holds Python objects.
        OSError: As `open`.
    """
    try:
        with open_file(path) as file, zipfile.ZipFile(file) as archive:
            check_size(path, sum(each.file_size for each in archive.infolist()))
            members = {each.filename.removesuffix(".npy"): each for each in archive.infolist()}
            chosen = members if names is None else names
            return {name: _read_member(archive, members[name]) for name in chosen}
    except _DAMAGES as error:
        raise ValueError(str(error) or type(error).__name__) from error


def map_npy(path: Path, writable: bool = False) -> NDArray[Any]:
    """Map the array of an .npy file into memory.

    Args:
        path: The file.
        writable: Whether what is assigned to the array is written to the file.

    Returns:
        The array, of which nothing is read before it is used.

    Raises:
        InputError: It is no regular file.
        ValueError: The file is damaged, no array, or holds Python objects.
        OSError: As `open`.
    """
    try:
        with open_file(path) as file:
            _check_header(file, os.fstat(file.fileno()).st_size)
        return npy.open_memmap(path, "r+" if writable else "r")
    except _DAMAGES as error:
        raise ValueError(str(error) or type(error).__name__) from error


def allocate_npy(path: Path, dtype: type, shape: tuple[int, ...]) -> None:
    """Make an .npy file of zeros that has all its room on the disk.

    A file without its room ends the process without a message where a map of it is written to a
    full disk.

    Args:
        path: The file.
        dtype: Type of the array.
        shape: Its shape.

    Raises:
        OSError: The disk is too full, and there is no such file now.
    """
    try:
        npy.open_memmap(path, "w+", dtype, shape).flush()
        if hasattr(os, "posix_fallocate"):
            with path.open("rb+") as file:
                os.posix_fallocate(file.fileno(), 0, os.fstat(file.fileno()).st_size)
    except OSError as error:
        path.unlink(missing_ok=True)
        error.filename = str(path)
        raise


def check_size(path: Path, unpacked: int) -> None:
    """Refuse a file that unpacks to far more than it has.

    Args:
        path: The file.
        unpacked: The size of its content, as it states.

    Raises:
        InputError: That is too much.
    """
    most = min(max(_ALWAYS, _RATIO * os.path.getsize(path)), _MOST)
    if unpacked > most:
        raise InputError(
            f"{path} would unpack to {unpacked / 1e6:,.0f} MB, and up to {most / 1e6:,.0f} MB are "
            "read of a file of its size; is it the file that you mean?"
        )


def check_zip(path: Path) -> None:
    """Refuse a ZIP archive, such as a checkpoint of torch, as `check_size` does.

    Raises:
        InputError: It unpacks to far more than it has.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            check_size(path, sum(each.file_size for each in archive.infolist()))
    except _DAMAGES:
        return  # its reader says what is wrong


def _read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(member) as stream:
        _check_header(stream, member.file_size)  # type: ignore[arg-type]
    with archive.open(member) as stream:
        array: NDArray[Any] = npy.read_array(stream, allow_pickle=False)
    return array


def _check_header(stream: BufferedIOBase, size: int) -> None:
    """Compare the size of an array, as its header states it, with that of its member."""
    readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
    version = npy.read_magic(stream)
    if version not in readers:
        raise ValueError(f"an array has version {version}")
    shape, _, dtype = readers[version](stream)
    if dtype.hasobject:
        raise ValueError("it holds Python objects, which are not loaded, since they could run code")
    stated = math.prod(shape) * dtype.itemsize
    if min(shape, default=0) < 0 or stated != size - stream.tell():
        raise ValueError(f"an array of {stated:,} bytes has {size - stream.tell():,}")
