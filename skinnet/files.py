"""Files that are written completely or not at all, and what a file is by its content."""

import os
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex

from skinnet._version import __version__
from skinnet.errors import InputError

READ_ERRORS = (
    *(OSError, SyntaxError, ValueError, EOFError, TypeError, RuntimeError, MemoryError),
    *(ArithmeticError, LookupError, AttributeError, struct.error, zlib.error),
)
"""What readers of pictures, meshes and arrays raise on damaged files."""


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


_STARTS = (
    (b"version https://git-lfs", "a pointer of Git LFS", "fetch the file itself: git lfs pull"),
    (b"version https://hawser", "a pointer of Git LFS", "fetch the file itself: git lfs pull"),
    (b"/annex/objects/", "a pointer of git-annex", "fetch the file itself: git annex get"),
    (b"\x1f\x8b", "a gzip archive", "unpack it"),
    (b"BZh", "a bzip2 archive", "unpack it"),
    (b"\xfd7zXZ", "an xz archive", "unpack it"),
    (b"(\xb5/\xfd", "a zstd archive", "unpack it"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it"),
    (b"Rar!", "a RAR archive", "unpack it"),
    (b"\x89HDF", "a file in HDF5, such as a model of Keras", ""),
    (b"GGUF", "a model in GGUF", ""),
    (b"\x93NUMPY", "an array of NumPy", ""),
    (b"\x89PNG", "a picture", "give it as the input"),
    (b"\xff\xd8\xff", "a picture", "give it as the input"),
    (b"%PDF", "a PDF file", ""),
)
"""First bytes of files that people take for others, what they are, and what to do."""

_PAGES = (b"<!doctype", b"<html", b"<head", b"<?xml", b"<error")
_EXPORT = "export it: python -m export"


def _describe_content(path: Path) -> tuple[str, str] | None:
    """Say what a file is that is not what its name promises, and what to do; None if unknown."""
    with path.open("rb") as file:
        head = file.read(1024)
    if not head:
        return "empty", "copy it again"
    for start, what, remedy in _STARTS:
        if head.startswith(start):
            return what, remedy
    if head.startswith(b"PK\x03\x04"):
        return _describe_archive(path)
    if head[:2] in (b"\x80\x02", b"\x80\x03", b"\x80\x04", b"\x80\x05"):
        return "a pickle, such as an old checkpoint of torch", ""
    if head[8:10] == b'{"' and int.from_bytes(head[:8], "little") < path.stat().st_size:
        return "weights in safetensors", f"{_EXPORT} {path} -o skin.onnx"
    if head[4:8] in (b"TFL3", b"ORTM"):
        return {b"TFL3": "a model of TensorFlow Lite", b"ORTM": "a model in ORT format"}[
            head[4:8]
        ], ""
    if re.match(rb"\x08[\x01-\x7f]\x12", head):
        return "a model in ONNX", ""
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    if text.startswith(_PAGES):
        return "a web page", "download the file itself, not the page that shows it"
    if text.startswith((b"{", b"[")):
        return "JSON, such as the answer of a server", "download the file itself"
    return None


def _describe_archive(path: Path) -> tuple[str, str]:
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError):
        return "a ZIP archive that is cut short", "copy it again"
    if any(name.endswith("data.pkl") for name in names):
        return "a checkpoint of torch", f"{_EXPORT} {path} -o skin.onnx"
    if names and all(name.endswith(".npy") for name in names):
        return "an .npz archive of arrays", ""
    return "a ZIP archive", "unpack it"


def _explain_format(found: object, known: int, version: object) -> str:
    """Say which skinnet wrote a file of another format, and how to get it.

    Args:
        found: The file's format.
        known: The format that is read here.
        version: The version that wrote the file; None where the file does not say.
    """
    who = f"skinnet {version}" if version else "another version of skinnet"
    wrote = f"{who} wrote it, and this is skinnet {__version__}"
    text = str(found)
    if text.isdecimal() and int(text) > known:
        return f"{wrote}: pip install -U skinnet"
    known_here = version in (None, __version__)
    return wrote if known_here else f'{wrote}: pip install "skinnet=={version}"'
