"""Arrays and a header in one .npz file, which is checked before anything large is read."""

import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from tokenize import TokenError
from typing import Any, NamedTuple

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, write_atomically

_HEADER = "header"
_LARGEST_HEADER = 4_000_000
_ALWAYS, _RATIO, _MEMBERS = 100_000_000, 50, 100
"""Bytes that any file may hold, bytes for each of its own, and the largest number of arrays."""

_TYPES = frozenset("float32 float64 uint8 uint16 bool int64".split())
_DAMAGES = (zipfile.BadZipFile, zlib.error, TokenError, NotImplementedError, *READ_ERRORS)


class ArrayType(NamedTuple):
    """What the head of an array in a file states: its type and its shape."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of bytes of its values."""
        return self.dtype.itemsize * math.prod(self.shape)


def write_arrays(path: Path, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write a header of plain types, and arrays, completely or not at all.

    Raises:
        InputError: The file cannot be written.
    """
    text = json.dumps(header).encode()
    members = {_HEADER: np.frombuffer(text, np.uint8), **arrays}
    try:
        with (
            write_atomically(path) as part,
            # The lowest level: maps of floats hardly become smaller, and wait for it.
            zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        ):
            for name, values in members.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                    npy.write_array(member, np.ascontiguousarray(values), allow_pickle=False)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{path} cannot be written ({reason}); choose another folder.") from error


class ArrayFile:
    """An open file of arrays; a member is read when it is asked for.

    Args:
        archive: The open archive.

    Raises:
        ValueError: An array has a type or a size other than those that it states.
    """

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self._archive = archive
        self.types = {
            info.filename.removesuffix(".npy"): _read_type(archive, info)
            for info in archive.infolist()
        }
        if self.types[_HEADER].size > _LARGEST_HEADER:
            raise ValueError("its header is too large")
        text = self.read(_HEADER, (self.types[_HEADER].size,), "uint8").tobytes()
        self.header: dict[str, Any] = json.loads(text)

    def read(self, name: str, shape: tuple[int | None, ...], dtype: str) -> NDArray[Any]:
        """Read an array of a shape, in which None is any size, and a type.

        Raises:
            ValueError: It has another shape or type, is damaged, or holds NaN or infinite values.
            KeyError: There is none of this name.
        """
        found = self.types[name]
        fits = len(found.shape) == len(shape) and all(
            wanted in (None, size) for wanted, size in zip(shape, found.shape, strict=True)
        )
        if not fits or found.dtype.name != dtype:
            raise ValueError(f"{name} has shape {list(found.shape)} and type {found.dtype}")
        with self._archive.open(f"{name}.npy") as member:
            _read_head(member)
            content = member.read(found.size + 1)
        if len(content) != found.size:
            raise ValueError(f"{name} is cut short")
        values = np.frombuffer(content, found.dtype).reshape(found.shape).copy()
        if found.dtype.kind == "f" and not np.isfinite(values).all():
            raise ValueError(f"{name} has values that are NaN or infinite")
        return values


def open_arrays(path: Path) -> zipfile.ZipFile:
    """Open the archive of a file that `write_arrays` wrote.

    Raises:
        InputError: There is none, or it is no archive.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder; give a file that Decomposition.save wrote.")
    try:
        archive = zipfile.ZipFile(path)
        sizes = [member.file_size for member in archive.infolist()]
        if len(sizes) > _MEMBERS or sum(sizes) > max(_ALWAYS, _RATIO * path.stat().st_size):
            archive.close()
            raise ValueError(f"it would unpack to {len(sizes)} files of {sum(sizes):,} bytes")
        return archive
    except FileNotFoundError:
        raise InputError(f"There is no file {path}; check the path.") from None
    except _DAMAGES as error:
        raise describe_damage(path, error) from error


def describe_damage(path: Path, error: BaseException) -> InputError:
    """Say that a file is not one that was saved, or not as it was saved."""
    reason = f"{type(error).__name__}: {error}".splitlines()[0][:120]
    return InputError(
        f"{path} is no decomposition, or it is damaged ({reason}); give a file that "
        "Decomposition.save wrote, or save it again."
    )


DAMAGES = _DAMAGES
"""What reading a damaged file raises."""


def _read_type(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> ArrayType:
    """Read what an array states, and compare it with the size that the archive states."""
    with archive.open(info) as member:
        shape, dtype, head = _read_head(member)
    found = ArrayType(dtype, shape)
    if dtype.name not in _TYPES or found.size + head != info.file_size:
        raise ValueError(f"{info.filename} is not the array that it states")
    return found


def _read_head(member: Any) -> tuple[tuple[int, ...], np.dtype[Any], int]:
    """The shape, the type, and the length of the head of an array that is read from its start."""
    version = npy.read_magic(member)
    if version != (1, 0):
        raise ValueError(f"it has an array of version {version}")
    shape, fortran, dtype = npy.read_array_header_1_0(member, max_header_size=1000)
    if fortran or not dtype.isnative or any(side < 0 for side in shape):
        raise ValueError("it has an array in another order")
    return shape, dtype, member.tell()
