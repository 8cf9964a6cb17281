"""Lists of paths and URLs: one a line, or the column of a CSV file."""

import csv
import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from io import StringIO
from typing import NoReturn

from pyarrow.fs import FileInfo

from skinnet.batch._photographs import NO_ROW, UNKNOWN, Photograph
from skinnet.batch._places import Place, find_place
from skinnet.errors import InputError

PATH_COLUMN = "path"

_THREADS = 16
"""A store answers a question about a file in tens of milliseconds; many are asked at once."""


def list_paths(place: Place, column: str | None) -> list[Photograph]:
    """List the photographs that a text or CSV file names.

    Args:
        place: The file. Paths in it that are relative start at its folder.
        column: The column of a CSV file; None for `path`.

    Raises:
        InputError: It is no text, has no such column, or names nothing.
    """
    text = _decode(place)
    if place.path.lower().endswith(".txt"):
        if column is not None:
            _refuse(place, f"is a list with one path a line, and has no column {column}")
        names: Iterable[str] = (line.strip("\r\n") for line in StringIO(text))
    else:
        names = _read_column(place, text, column or PATH_COLUMN)
    found = [name for name in names if name.strip()]
    if not found:
        _refuse(place, "names no photographs")
    return describe_paths(place, found)


def describe_paths(place: Place, names: Iterable[str]) -> list[Photograph]:
    """Look up size and time of the files that are named in a list, many at once."""
    with ThreadPoolExecutor(_THREADS) as pool:
        return list(pool.map(lambda name: _describe(place, name), names))


def _decode(place: Place) -> str:
    try:
        return place.read().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{place.url} is not text in UTF-8 (byte {error.start}); save it in UTF-8."
        ) from error


def _read_column(place: Place, text: str, column: str) -> Iterator[str]:
    tabs = place.path.lower().endswith(".tsv")
    table = csv.DictReader(StringIO(text), delimiter="\t" if tabs else ",")
    try:
        known = table.fieldnames or ()
        if column not in known:
            raise InputError(
                f"{place.url} has no column {column}; its columns are {', '.join(known)}. Name the "
                "one with the paths: --path-column."
            )
        yield from (row[column] or "" for row in table)
    except csv.Error as error:
        raise InputError(f"{place.url} is not a CSV file ({error}); save it again.") from error


def _describe(place: Place, name: str) -> Photograph:
    try:
        target = find_place(_complete(place, name))
        info = target.stat()
    except InputError as error:
        return Photograph(name, name, fault=str(error))
    if not info.is_file:
        what = "is a folder" if info.type.name == "Directory" else "does not exist"
        fault = f"{name} {what}; check the list {place.url}."
        return Photograph(name, target.url, fault=fault)
    return Photograph(name, target.url, NO_ROW, _get_size(info), info.mtime_ns or 0)


def _complete(place: Place, name: str) -> str:
    """A path as it is read from the folder of the list."""
    folder = place.url.rpartition("/")[0]
    if "://" in name or os.path.isabs(name):
        return name
    return f"{folder}/{name}"


def _get_size(info: FileInfo) -> int:
    return UNKNOWN if info.size is None else int(info.size)


def _refuse(place: Place, what: str) -> NoReturn:
    raise InputError(f"{place.url} {what}; check the list.")
