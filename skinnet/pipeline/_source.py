"""What results were made from, and whose results the files in a folder are."""

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.files._npz import read_npz
from skinnet.files._reading import MOST_TEXT, open_file, read_file
from skinnet.images._mark import Mark, parse_mark, read_mark
from skinnet.images._result_names import compute_digest, describe_input, is_input

_HEAD = 4096
"""Bytes at the start of a mesh or a material in which its mark stands."""

_INNER_MARK = b"tEXtskinnet\0"
"""What stands before the mark of a PNG file."""

_RECORD_END = "_shape.json"
_OLD_MESHES = {"_face": "_maps.npz", "_shape": "_shape.npz"}
"""Ends of the names of meshes that are results, and of the archives beside them."""


@dataclass(frozen=True)
class Source:
    """The files that results are made from, with their digests.

    Args:
        paths: The files.
        digests: SHA-256 of each; for a result, that of the file from which it was made in turn, so
            that maps that were made again are still those of the same scan.
    """

    paths: tuple[Path, ...]
    digests: tuple[str, ...]

    @classmethod
    def read(cls, paths: Sequence[Path]) -> "Source":
        """Read the digests of scans, or of results of earlier steps."""
        return cls(tuple(paths), tuple(_read_digest(path) for path in paths))

    @property
    def digest(self) -> str:
        """One digest of all files."""
        if len(self.digests) == 1:
            return self.digests[0]
        return hashlib.sha256("".join(self.digests).encode()).hexdigest()

    def make_mark(self, verb: str, part: str) -> Mark:
        """Make the mark of a result."""
        return Mark(verb, part, self.digest)

    def describe(self, verb: str, part: str, folder: Path) -> dict[str, Any]:
        """Describe the origin of a result in a folder, for a JSON file or the header of a .npz."""
        inputs = [
            describe_input(path, digest, folder)
            for path, digest in zip(self.paths, self.digests, strict=True)
        ]
        mark = str(self.make_mark(verb, part))
        return {"mark": mark, "input": inputs[0] if len(inputs) == 1 else inputs}

    def owns(self, file: Path) -> bool:
        """Whether a file is a result of these files, so that it may be replaced by a new one."""
        record = _read_record(file)
        if "input" in record:
            return self._is_described(record["input"], file.parent)
        mark = read_result_mark(file)
        if mark is not None and mark.version:
            return mark.digest == self.digest
        return self._owned_before_marks(file)

    def _is_described(self, described: object, folder: Path) -> bool:
        inputs = described if isinstance(described, list) else [described]
        return len(inputs) == len(self.paths) and all(
            isinstance(one, dict) and is_input(one, path, digest, folder)
            for one, path, digest in zip(inputs, self.paths, self.digests, strict=True)
        )

    def _owned_before_marks(self, file: Path) -> bool:
        """Whether a file of an earlier version lies beside a record that names the same scan."""
        stem = file.stem.rpartition("_")[0]
        record = _read_record(file.with_name(stem + _RECORD_END))
        if not file.is_file() or "inputs" not in record or "input" in record:
            return False
        known = record.get("file")
        return isinstance(known, str) and all(
            os.path.realpath(known) == os.path.realpath(path) for path in self.paths
        )


def choose_folder(given: Path | None, default: Path, names: Sequence[str], source: Source) -> Path:
    """Choose the folder of results whose names in it are fixed.

    Args:
        given: The folder that the user names.
        default: The folder without such a name.
        names: Names of the results.
        source: What they are made from.

    Returns:
        The folder. The default one gets a number where it holds other results of these names.

    Raises:
        InputError: The folder that the user names holds other files of these names.
    """
    if given is not None:
        for name in names:
            file = given / name
            if os.path.lexists(file) and not source.owns(file):
                raise InputError(
                    f"{file} is there already and was not made from {_describe(source)}; choose "
                    "another folder with -o, or move it away."
                )
        return given
    folder, number = default, 1
    while any(os.path.lexists(folder / name) and not source.owns(folder / name) for name in names):
        number += 1
        folder = default.with_name(f"{default.name}-{number}")
    return folder


def read_result_mark(path: Path) -> Mark | None:
    """Read the mark of a result: a picture, an archive, a mesh, a material or a record."""
    if path.suffix.lower() in (".npz", ".json"):
        return parse_mark(_read_record(path).get("mark"))
    if path.suffix.lower() in (".obj", ".mtl"):
        return _read_comment(path)
    if path.suffix.lower() in (".glb", ".usdz"):
        return _read_inner_mark(path)
    return read_mark(path)


def find_result_verb(path: Path) -> str | None:
    """Find the verb that wrote a mesh or an archive of maps; None for a scan and others' files."""
    mark = read_result_mark(path)
    if mark is not None:
        return mark.verb or "maps"
    stem = path.stem
    for end, archive in _OLD_MESHES.items():
        name = stem.removesuffix(end)
        if path.suffix == ".obj" and name != stem and path.with_name(name + archive).is_file():
            return "fit-shape" if end == "_shape" else "maps"
    return None


def _describe(source: Source) -> str:
    count = len(source.paths)
    return str(source.paths[0]) if count == 1 else f"these {count} files"


def _read_digest(path: Path) -> str:
    mark = read_result_mark(path)
    try:
        return mark.digest if mark is not None and mark.digest else compute_digest(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); check the path.") from error


def _read_record(path: Path) -> dict[str, Any]:
    """Read a JSON file, or what an archive states of itself; empty if it is something else."""
    try:
        text: str | bytes
        if path.suffix.lower() == ".json":
            text = read_file(path, MOST_TEXT)
        elif path.suffix.lower() == ".npz":
            text = _read_origin(path)
        else:
            return {}
        record = json.loads(text)
    except READ_ERRORS:
        return {}
    return record if isinstance(record, dict) else {}


def _read_origin(path: Path) -> str:
    try:
        return str(read_npz(path, ["header"])["header"])
    except KeyError:
        return str(read_npz(path, ["origin"])["origin"])


def _read_inner_mark(path: Path) -> Mark | None:
    """Read the mark of the pictures in a GLB or USDZ file, which holds them as they are."""
    try:
        texts = read_file(path).split(_INNER_MARK)[1:]
    except (OSError, InputError):
        return None
    return next((mark for text in texts if (mark := parse_mark(text[:_HEAD]))), None)


def _read_comment(path: Path) -> Mark | None:
    try:
        with open_file(path) as file:
            lines = file.read(_HEAD).splitlines()
    except (OSError, InputError):
        return None
    comments = (line[1:].strip() for line in lines if line.startswith(b"#"))
    return next((mark for line in comments if (mark := parse_mark(line))), None)
