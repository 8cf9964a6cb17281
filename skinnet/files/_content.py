"""What a file is by its content, and which skinnet wrote it."""

import re
import zipfile
from pathlib import Path

from skinnet._version import __version__
from skinnet.errors import _clip

_PHOTOGRAPHS = "skinnet predict and skinnet edit take photographs as the input"

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
    (b"\x89PNG", "a picture", _PHOTOGRAPHS),
    (b"\xff\xd8\xff", "a picture", _PHOTOGRAPHS),
    (b"%PDF", "a PDF file", ""),
)
"""First bytes of files that people take for others, what they are, and what to do."""

_PAGES = (b"<!doctype", b"<html", b"<head", b"<?xml", b"<error")
_EXPORT = "export it: python -m export"


def describe_content(path: Path) -> tuple[str, str] | None:
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


def explain_format(found: object, known: int, version: object) -> str:
    """Say which skinnet wrote a file of another format, and how to get it.

    Args:
        found: The file's format.
        known: The format that is read here.
        version: The version that wrote the file; None where the file does not say.
    """
    who = f"skinnet {_clip(version)}" if version else "another version of skinnet"
    wrote = f"{who} wrote it, and this is skinnet {__version__}"
    text = str(found)
    if text.isdecimal() and int(text) > known:
        return f"{wrote}: pip install -U skinnet"
    known_here = version in (None, __version__)
    return wrote if known_here else f'{wrote}: pip install "skinnet=={_clip(version)}"'
