"""Whose results lie in a folder: an input finds its own, and replaces nothing else."""

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from skinnet.errors import InputError
from skinnet.images._mark import EDITED, read_mark, read_summary
from skinnet.images._result_names import OUTPUT, choose_stem, describe_input, is_input


class Source(NamedTuple):
    """An input: its name in messages, its file (None for standard input) and its SHA-256."""

    name: str
    path: Path | None
    digest: str

    @property
    def stem(self) -> str:
        """How the names of its results begin, if nothing else has that name."""
        return "stdin" if self.path is None else self.path.stem

    @property
    def folder(self) -> Path:
        """The folder that it lies in."""
        return Path() if self.path is None else self.path.parent

    def describe(self, folder: Path) -> dict[str, str | None]:
        """Return the record of the input for a summary in a folder."""
        return describe_input(self.path, self.digest, folder)


def choose_result_stem(folder: Path, source: Source, ends: Iterable[str]) -> str:
    """Choose how the names of an input's results begin, so that they replace only their like."""
    return choose_stem(folder, source.stem, ends, lambda file: _is_result_of(file, source))


def choose_edit_target(
    source: Source, output: Path | None, suffix: str, folder: Path | None = None
) -> Path:
    """Choose the file of an edited photograph.

    Args:
        source: The photograph.
        output: The file that the user has named; None for INPUT_edited with the suffix, and with a
            number if a file of that name is not an edit of the same photograph.
        suffix: Suffix of a name that the user has not chosen, such as `.png`.
        folder: Where a name that the user has not chosen is written; the photograph's by default.

    Raises:
        InputError: The user's file is the photograph itself, or exists and is not its edit.
    """
    if output is None:
        stem = f"{source.stem}_{EDITED}"
        folder = source.folder if folder is None else folder
        number = choose_stem(folder, stem, (suffix,), lambda file: _is_edit(file, source))
        return folder / f"{number}{suffix}"
    if source.path is not None and _is_same_file(output, source.path):
        raise InputError(f"{output} is the photograph itself; choose another file with -o.")
    if os.path.lexists(output) and not _is_edit(output, source):
        raise InputError(
            f"{output} exists, and is not an edit of {source.name} by skinnet; choose another file "
            "with -o, or remove it."
        )
    return output


def _is_same_file(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other)
    except (OSError, ValueError):
        return False


def _is_edit(file: Path, source: Source) -> bool:
    if file.is_dir():
        return True  # it is not replaced; writing says that it is in the way
    mark = read_mark(file)
    own = mark is not None and mark.part == EDITED and mark.digest == source.digest
    return own and not (source.path is not None and _is_same_file(file, source.path))


def _is_result_of(file: Path, source: Source) -> bool:
    if file.is_dir():
        return True  # it is not replaced; writing says that it is in the way
    if file.suffix.lower() == ".json":
        return _is_summary_of(file, source)
    mark = read_mark(file)
    if mark is None or mark.part == EDITED:
        return False
    if mark.digest:
        return mark.digest == source.digest
    words = file.stem.split("_")
    stems = ("_".join(words[:count]) for count in range(1, len(words)))
    return any(_is_summary_of(file.with_name(f"{stem}.json"), source) for stem in stems)


def _is_summary_of(file: Path, source: Source) -> bool:
    summary = read_summary(file)
    if summary is None:
        return False
    record = summary.get("input")
    if isinstance(record, dict):
        return is_input(record, source.path, source.digest, file.parent)
    return source.path is not None and _is_early_summary_of(summary, file, source.path)


def _is_early_summary_of(summary: dict[str, Any], file: Path, photo: Path) -> bool:
    """Whether a summary without a digest, of an earlier version, is surely of this photograph."""
    known = Path(str(summary.get("file", "")))
    if not known.is_absolute():
        if file.parent.name != OUTPUT:
            return False  # it was relative to the folder in which the command ran then
        known = file.parent.parent / known.name
    return _is_same_file(known, photo)
