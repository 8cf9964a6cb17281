"""Files that are written completely or not at all."""

import os
import re
import socket
import threading
import time
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex

from skinnet.errors import InputError, _explain_fault


def _name_host() -> str:
    """Name the machine, or the container, in which the number of a process means a process."""
    name = socket.gethostname()
    with suppress(OSError, AttributeError):
        name += os.readlink("/proc/self/ns/pid")
    return f"{zlib.crc32(name.encode()):08x}"


_HOST = _name_host()
_PARTIAL = re.compile(r"\.skinnet-([0-9a-f]{8})-(\d+)-[0-9a-f]{12}\.(?:part|old)(?:\..*)?")
"""Names of partial files: the machine and the process that write them."""

_EARLIER = re.compile(r"\.(?:[0-9a-f]{12}\.(?:part|old)(?:\.\w+)?|last\.ckpt\.part)")
"""Names that earlier versions gave, which do not say who writes them."""

_ABANDONED = 86400.0
"""Seconds after which a partial file is abandoned whose process is not known here."""

_sweeping = threading.Lock()
_looked_at: set[Path] = set()
_own: set[str] = set()
_removed: list[Path] = []


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
        sweep(path.parent)
        return parts.setdefault(path, _name_beside(path, "part"))

    renamed: list[Path] = []
    older: dict[Path, Path] = {}
    try:
        yield name_temporary
        for path, part in parts.items():
            _keep_older(path, older)
            os.replace(part, path)
            renamed.append(path)
    except BaseException as error:
        _take_back(renamed, parts, older)
        if isinstance(error, OSError):
            _name_target(error, parts)
        raise
    for kept in older.values():
        kept.unlink(missing_ok=True)


def _take_back(renamed: list[Path], parts: dict[Path, Path], older: dict[Path, Path]) -> None:
    """Remove what was written, as far as the disk lets us, and put older files back."""
    for path in (*parts.values(), *(path for path in renamed if path not in older)):
        with suppress(OSError):
            path.unlink(missing_ok=True)
    for path, kept in older.items():
        with suppress(OSError):
            os.replace(kept, path)
            kept.unlink(missing_ok=True)  # it stays where both are names of one file


def _name_target(error: OSError, parts: dict[Path, Path]) -> None:
    """Have an error name a file as the user knows it; a full disk names none, or a partial one."""
    targets = {str(part): str(path) for path, part in parts.items()}
    name = str(error.filename) if error.filename is not None else ""
    if parts and (not name or name in targets):
        error.filename = targets.get(name, str(next(reversed(parts))))
        error.filename2 = None


def sweep(folder: Path) -> None:
    """Remove the partial files that killed processes have left in a folder, once for each.

    Whatever is written into a folder does so by itself.

    Args:
        folder: The folder; it need not exist.
    """
    folder = folder.absolute()
    with _sweeping, suppress(OSError):
        if folder in _looked_at:
            return
        _looked_at.add(folder)
        for entry in os.scandir(folder):
            with suppress(FileNotFoundError):  # another process has removed it
                if entry.name not in _own and _is_abandoned(entry):
                    os.unlink(entry.path)
                    _removed.append(Path(entry.path))


def take_removed() -> list[Path]:
    """Take the list of partial files that were removed, which an interrupted process had left."""
    taken = list(_removed)
    _removed.clear()
    return taken


def add_removed(paths: Iterable[Path]) -> None:
    """Add partial files that another process of the same run has removed."""
    _removed.extend(paths)


@contextmanager
def write_aside(folder: Path) -> Iterator[Callable[[str], Path]]:
    """Write files of a folder before it is known what they are called.

    Args:
        folder: The folder.

    Yields:
        A function from a suffix, such as `.png`, to a temporary path in the folder. What has not
        been renamed at the end is removed.
    """
    parts: list[Path] = []

    def name_temporary(suffix: str) -> Path:
        sweep(folder)
        parts.append(_name_beside(folder / f"a{suffix}", "part"))
        return parts[-1]

    try:
        yield name_temporary
    finally:
        for part in parts:
            part.unlink(missing_ok=True)


def _name_beside(path: Path, kind: str) -> Path:
    name = f".skinnet-{_HOST}-{os.getpid()}-{token_hex(6)}.{kind}{path.suffix}"
    _own.add(name)
    return path.with_name(name)


def _is_abandoned(entry: "os.DirEntry[str]") -> bool:
    found = _PARTIAL.fullmatch(entry.name)
    if found is None and _EARLIER.fullmatch(entry.name) is None:
        return False
    if found is not None and found[1] == _HOST and os.name == "posix":
        return not _is_running(int(found[2]))
    return time.time() - entry.stat(follow_symlinks=False).st_mtime > _ABANDONED


def _is_running(process: int) -> bool:
    """Whether a process of this machine runs; files with the number of this one are another's."""
    if process == os.getpid():
        return False
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # it is another user's
        return True
    return True


def _keep_older(path: Path, older: dict[Path, Path]) -> None:
    """Give a file that is about to be replaced a second name, until all have been written."""
    kept = _name_beside(path, "old")
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
        raise InputError(f"{folder} cannot be made {_explain_fault(error, remedy)}.") from error
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
