"""Which photographs an input holds: a folder, a list, or Parquet files; here or in a store."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from pyarrow.fs import FileInfo, FileType

from skinnet.batch._lists import list_paths
from skinnet.batch._parquet_input import find_files, list_rows
from skinnet.batch._photographs import NO_ROW, UNKNOWN, Photograph
from skinnet.batch._places import Place, find_place
from skinnet.errors import InputError
from skinnet.images._kind import has_picture_ending
from skinnet.images._walk import describe_formats, walk

_LISTS = (".txt", ".csv", ".tsv")


class Columns(NamedTuple):
    """Names of the columns of an input; None for the usual ones.

    Attributes:
        path: Paths in a CSV or Parquet file.
        bytes: Files of pictures in a Parquet file.
        name: Their names.
    """

    path: str | None = None
    bytes: str | None = None
    name: str | None = None


@dataclass
class Listing:
    """The photographs of an input, and what the user should know of it."""

    place: Place
    photographs: list[Photograph]
    notes: list[str] = field(default_factory=list)


def list_photographs(name: str, columns: Columns, recursive: bool = False) -> Listing:
    """List the photographs of an input.

    Args:
        name: A folder, a list of paths (.txt, .csv, .tsv), a Parquet file or a folder of them, or a
            photograph; a path or a URL.
        columns: Names of columns.
        recursive: Whether to search the subfolders of a folder.

    Raises:
        InputError: It does not exist, or holds no photographs.
    """
    place = find_place(name)
    info = place.stat()
    if info.type == FileType.NotFound:
        raise InputError(f"There is no file or folder {name}; check the path.")
    if info.type == FileType.File and place.path.lower().endswith(_LISTS):
        return _take_once(place, list_paths(place, columns.path))
    if files := find_files(place, info, recursive):
        return _take_once(place, list_rows(files, columns.path, columns.bytes, columns.name))
    _refuse_columns(name, columns)
    if place.is_local:
        return _walk(place, os.path.abspath(name), recursive)
    return _search(place, info, recursive)


def _refuse_columns(name: str, columns: Columns) -> None:
    for flag, value in zip(("path", "bytes", "name"), columns, strict=True):
        if value is not None:
            raise InputError(
                f"{name} has no columns, but --{flag}-column {value} was given; leave it out, or "
                "give a CSV or Parquet file."
            )


def _take_once(place: Place, photographs: Iterable[Photograph]) -> Listing:
    listed = list(photographs)
    found = {(each.source, each.row): each for each in listed}
    again = len(listed) - len(found)
    notes = [f"{again} photographs are listed more than once; each is read once."] * bool(again)
    return Listing(place, list(found.values()), notes)


def _walk(place: Place, name: str, recursive: bool) -> Listing:
    """List the photographs of a folder on this machine, by the content of its files."""
    found = walk([name], recursive)
    if len(found.pictures) == 1 and found.pictures[0].path == name and found.pictures[0].error:
        raise found.pictures[0].error
    listed = []
    for each in found.pictures:
        info = find_place(each.path).stat()
        fault = "" if each.error is None else str(each.error)
        listed.append(describe_file(each.path, each.path, info, fault))
    passed_over = found.describe_passed_over()
    notes = [*found.notes, *([f"Passed over: {passed_over}."] if passed_over else [])]
    return Listing(place, listed, notes)


def _search(place: Place, info: FileInfo, recursive: bool) -> Listing:
    """List the photographs of a folder in a store by the endings of their names."""
    if info.type == FileType.File:
        return Listing(place, [describe_file(place.url, place.url, info)])
    files = [(each, info) for each, info in place.list(recursive) if info.type == FileType.File]
    listed = [
        describe_file(each.url, each.url, info)
        for each, info in files
        if has_picture_ending(each.path) and not each.name.startswith(".")
    ]
    if not listed:
        deeper = "" if recursive else "; --recursive searches the folders below too"
        raise InputError(f"{place.url} holds no photographs; {describe_formats()}{deeper}.")
    others = len(files) - len(listed)
    notes = [f"Passed over: {others} files whose ending is not that of a picture."]
    return Listing(place, listed, notes * bool(others))


def describe_file(file: str, source: str, info: FileInfo, fault: str = "") -> Photograph:
    """Describe a photograph that is a file of its own."""
    size = UNKNOWN if info.size is None else info.size
    return Photograph(file, source, NO_ROW, size, info.mtime_ns or 0, fault)
