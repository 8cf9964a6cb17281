"""Photographs in Parquet files: their bytes and names, or their paths."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NoReturn

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pyarrow.fs import FileInfo, FileType

from skinnet.batch._lists import describe_paths
from skinnet.batch._photographs import UNKNOWN, Photograph
from skinnet.batch._places import Place, explain
from skinnet.errors import InputError

BYTES_COLUMN, NAME_COLUMN = "bytes", "name"

_ENDING = ".parquet"
_ROWS = 8
"""Photographs that are in memory at once."""

Files = Sequence[tuple[Place, FileInfo]]


def find_files(place: Place, info: FileInfo, recursive: bool) -> Files:
    """Find the Parquet files of an input; none if it holds anything else."""
    if info.type == FileType.File:
        return [(place, info)] if place.path.lower().endswith(_ENDING) else []
    found = [each for each in place.list(recursive) if each[1].type == FileType.File]
    shown = [each for each in found if not each[0].name.startswith((".", "_"))]
    return shown if all(each.path.lower().endswith(_ENDING) for each, _ in shown) else []


def list_rows(
    files: Files, path: str | None, bytes_: str | None, name: str | None
) -> Iterator[Photograph]:
    """List the photographs of Parquet files.

    Args:
        files: The files.
        path: Column of paths, which are read instead of bytes; None for bytes.
        bytes_: Column of bytes; None for `bytes`.
        name: Column of names; None for `name`.

    Raises:
        InputError: A file is damaged, has no such column, or none has a row.
    """
    empty = True
    for place, info in files:
        with open_parquet(place) as file:
            listed = _list_file(place, info, file, path, bytes_, name)
        empty = empty and not listed
        yield from listed
    if empty:
        raise InputError(f"{files[0][0].url} has no rows; give Parquet files with photographs.")


def _list_file(
    place: Place,
    info: FileInfo,
    file: pq.ParquetFile,
    path: str | None,
    bytes_: str | None,
    name: str | None,
) -> list[Photograph]:
    if path is not None:
        _check_column(place, file, "path", path, _is_text)
        paths = _get_column(file.read([path]), path).to_pylist()
        return describe_paths(place, [each for each in paths if each])
    _check_column(place, file, "bytes", bytes_ or BYTES_COLUMN, _is_binary)
    _check_column(place, file, "name", name or NAME_COLUMN, _is_text)
    size, modified = UNKNOWN if info.size is None else info.size, info.mtime_ns or 0
    return [
        Photograph(f"row {row} of {place.url}", place.url, row, size, modified)
        for row in range(file.metadata.num_rows)
    ]


def read_rows(
    place: Place, rows: Sequence[int], bytes_: str, name: str
) -> Iterator[tuple[str | None, bytes | None]]:
    """Read names and bytes of photographs, a few at once.

    Args:
        place: The Parquet file.
        rows: Row numbers, in ascending order.
        bytes_: Column of bytes.
        name: Column of names.
    """
    wanted = iter(rows)
    row = next(wanted, None)
    with open_parquet(place) as file:
        for start, batch in _list_batches(file, rows, [bytes_, name]):
            while row is not None and row < start + len(batch):
                each = batch.slice(row - start, 1)
                data, text = (_get_column(each, column)[0].as_py() for column in (bytes_, name))
                yield text, data
                row = next(wanted, None)


def _list_batches(
    file: pq.ParquetFile, rows: Sequence[int], columns: list[str]
) -> Iterator[tuple[int, pa.Table]]:
    """Batches of the groups that hold rows, with the number of the first row of each."""
    start = 0
    for group in range(file.num_row_groups):
        end = start + file.metadata.row_group(group).num_rows
        if any(start <= row < end for row in rows):
            first = start
            for batch in file.iter_batches(_ROWS, [group], columns, use_threads=False):
                yield first, pa.Table.from_batches([batch])
                first += len(batch)
        start = end


@contextmanager
def open_parquet(place: Place) -> Iterator[pq.ParquetFile]:
    """Open a Parquet file.

    Raises:
        InputError: It cannot be read, or is not a Parquet file.
    """
    with explain(place.url), place.filesystem.open_input_file(place.path) as file:
        with pq.ParquetFile(file) as parquet:
            yield parquet


def _check_column(place: Place, file: pq.ParquetFile, what: str, column: str, fits: Any) -> None:
    known = dict(_list_columns(file.schema_arrow))
    if column not in known:
        _refuse(place, f"has no column {column}", what, known)
    if not fits(known[column]):
        _refuse(place, f"has {known[column]} in the column {column}", what, known)


def _refuse(place: Place, fault: str, what: str, known: dict[str, pa.DataType]) -> NoReturn:
    listed = ", ".join(f"{name} ({kind})" for name, kind in known.items())
    raise InputError(
        f"{place.url} {fault}; its columns are {listed}. Name the one with the "
        f"{_WORDS[what]}: --{what}-column."
    )


_WORDS = {"path": "paths", "bytes": "pictures' bytes", "name": "names"}


def _list_columns(schema: pa.Schema) -> Iterator[tuple[str, pa.DataType]]:
    """Names and types; a field of a structure is STRUCTURE.FIELD, such as image.bytes."""
    for field in schema:
        if pa.types.is_struct(field.type):
            yield from ((f"{field.name}.{each.name}", each.type) for each in field.type)
        else:
            yield field.name, field.type


def _get_column(table: pa.Table, column: str) -> pa.ChunkedArray:
    if column in table.column_names:
        return table[column]
    outer, _, inner = column.partition(".")
    return pc.struct_field(table[outer], inner)


def _is_text(kind: pa.DataType) -> bool:
    return bool(pa.types.is_string(kind) or pa.types.is_large_string(kind))


def _is_binary(kind: pa.DataType) -> bool:
    return bool(pa.types.is_binary(kind) or pa.types.is_large_binary(kind))
