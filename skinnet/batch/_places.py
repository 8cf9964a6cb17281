"""Files and folders by their paths and URLs: on this machine, in s3://, gs://, and by fsspec."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from secrets import token_hex
from urllib.parse import urlsplit
from urllib.request import url2pathname

import pyarrow as pa
from pyarrow.fs import FileInfo, FileSelector, FileSystem, FileType, FSSpecHandler, PyFileSystem

from skinnet.errors import InputError

_URL = re.compile(r"([a-z][a-z0-9+.-]+)://([^/?#]*)/?([^?]*)(\?.*)?", re.DOTALL)
_CHECK_URL = "check the URL, your rights, and that its store can be reached from here"
_LONGEST = 200
_ERRORS = (OSError, pa.ArrowException, ValueError, RuntimeError, ImportError)


@dataclass(frozen=True)
class Place:
    """A file or a folder.

    Attributes:
        filesystem: The file system that it lies in.
        path: Its path there.
        url: How a user names it; on this machine the same as the path.
        query: What the URL states of its store, such as `?region=eu-west-1`.
    """

    filesystem: FileSystem
    path: str
    url: str
    query: str = ""

    @property
    def is_local(self) -> bool:
        """Whether it is a path, and not a URL."""
        return "://" not in self.url

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition("/")[2]

    def join(self, name: str) -> "Place":
        """A place below this one."""
        path, url = (each if each.endswith("/") else f"{each}/" for each in (self.path, self.url))
        return replace(self, path=path + name, url=url + name)

    def stat(self) -> FileInfo:
        """What kind of thing it is, its size and when it was changed."""
        with explain(self.url):
            return self.filesystem.get_file_info(self.path)

    def exists(self) -> bool:
        """Whether there is a file or a folder."""
        return bool(self.stat().type != FileType.NotFound)

    def list(self, recursive: bool = False) -> "list[tuple[Place, FileInfo]]":
        """List the files and folders below, by name; none if it does not exist."""
        selector = FileSelector(self.path, allow_not_found=True, recursive=recursive)
        with explain(self.url):
            found = self.filesystem.get_file_info(selector)
        start = len(self.path.rstrip("/")) + 1
        return [(self.join(each.path[start:]), each) for each in sorted(found, key=_get_path)]

    def read(self) -> bytes:
        """Read the file."""
        with explain(self.url), self.filesystem.open_input_stream(self.path) as file:
            data: bytes = file.read()
            return data

    def write(self, data: bytes) -> None:
        """Write the file whole or not at all; its folder must exist on this machine."""
        part = replace(self, path=f"{self.path}-{token_hex(4)}.part")
        with explain(self.url), self.filesystem.open_output_stream(part.path) as file:
            file.write(data)
        part.move(self)

    def make_folder(self) -> None:
        """Make the folder and those above it."""
        with explain(self.url):
            self.filesystem.create_dir(self.path, recursive=True)

    def move(self, target: "Place") -> None:
        """Give the file another name; a file of that name is replaced in one step."""
        with explain(target.url):
            self.filesystem.move(self.path, target.path)

    def delete(self) -> None:
        """Delete the file."""
        with explain(self.url):
            self.filesystem.delete_file(self.path)


def find_place(name: str) -> Place:
    """Find the place that a path or a URL names; it need not exist.

    Raises:
        InputError: There is no such kind of URL, or its store cannot be reached.
    """
    found = _URL.fullmatch(name)
    if found is None:
        path = Path(os.path.abspath(name)).as_posix()
        return Place(_open_local(), path, path)
    scheme, host, rest, query = found.groups()
    if scheme == "file":
        return find_place(url2pathname(urlsplit(name).path))
    with explain(name):
        filesystem, base = _open(scheme, host, query or "")
    place = Place(filesystem, base, f"{scheme}://{host}", query or "")
    return place.join(rest.rstrip("/")) if rest.rstrip("/") else place


@contextmanager
def explain(name: str) -> Iterator[None]:
    """Turn the errors of a file system into a sentence."""
    try:
        yield
    except InputError:
        raise
    except _ERRORS as error:
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        reason = " ".join(reason.split())[:_LONGEST].rstrip(".")
        remedy = _CHECK_URL if "://" in name else "check the path"
        raise InputError(f"{name} cannot be used ({reason}); {remedy}.") from error


@lru_cache(maxsize=1)
def _open_local() -> FileSystem:
    return FileSystem.from_uri("file:///")[0]


@lru_cache(maxsize=256)
def _open(scheme: str, host: str, query: str) -> tuple[FileSystem, str]:
    """Open the file system of a kind of URL, once in a process; its path of the host's root."""
    root = f"{scheme}://{host}"
    try:
        filesystem, path = FileSystem.from_uri(f"{root}/{query}" if query else root)
    except pa.ArrowInvalid as error:
        if "nrecognized filesystem" not in str(error):
            raise
        return _open_by_fsspec(root)
    return filesystem, path


def _open_by_fsspec(root: str) -> tuple[FileSystem, str]:
    try:
        import fsspec
    except ImportError as error:
        raise InputError(f"{root} needs fsspec: pip install fsspec.") from error
    filesystem, path = fsspec.core.url_to_fs(root)
    return PyFileSystem(FSSpecHandler(filesystem)), path


def _get_path(info: FileInfo) -> str:
    path: str = info.path
    return path
