"""A table to which runs append rows, each of them whole."""

import csv
import io
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from skinnet.errors import InputError, _explain_fault
from skinnet.images._result_names import lock_folder


class CsvFile:
    """A CSV file (UTF-8, commas) that grows by whole rows, also if several processes write.

    A file that is there is continued if it has the same columns; otherwise it is refused, and stays
    as it is. The heading is written at once where there is none.

    Args:
        path: The file.
        columns: Its columns.

    Raises:
        InputError: The file has other columns, ends in a part of a row, or cannot be written.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self.path, self.columns = path, tuple(columns)
        self.append(())

    def append(self, rows: Iterable[Mapping[str, Any]]) -> None:
        """Append rows, all or none.

        Args:
            rows: Cells by column; those that are None or missing are empty.

        Raises:
            InputError: The file cannot be written, or was replaced by another one.
        """
        try:
            # The folder first: without it, locking is silently left out.
            self.path.absolute().parent.stat()
            with lock_folder(self.path.absolute().parent), open(self.path, "a+b", 0) as file:
                self._append(file, rows)
        except OSError as error:
            raise InputError(
                f"{self.path} cannot be written "
                f"{_explain_fault(error, 'choose another file with --csv')}."
            ) from error

    def _append(self, file: io.FileIO, rows: Iterable[Mapping[str, Any]]) -> None:
        size = file.seek(0, os.SEEK_END)
        table = [[_make_cell(row.get(name)) for name in self.columns] for row in rows]
        data = _format([*([] if size else [self.columns]), *table])
        if size:
            self._check(file)
        try:
            while data:
                data = data[file.write(data) :]
            os.fsync(file.fileno())
        except BaseException:
            os.ftruncate(file.fileno(), size)
            raise

    def _check(self, file: io.FileIO) -> None:
        file.seek(0)
        first = file.readline(1 << 20).decode("utf-8-sig", "replace").rstrip("\r\n")
        if tuple(first.split(",")) != self.columns:
            raise InputError(
                f"{self.path} is there already and has other columns than skinnet's table of "
                "faces; choose another file with --csv, or move it away."
            )
        file.seek(-1, os.SEEK_END)
        if file.read(1) != b"\n":
            raise InputError(
                f"{self.path} ends in a part of a row; remove its last line, or choose another "
                "file with --csv."
            )


def _make_cell(value: Any) -> Any:
    """A cell without line breaks, so that a row is a line."""
    if not isinstance(value, str):
        return value
    return value.replace("\r", "\\r").replace("\n", "\\n")


def _format(table: Iterable[Sequence[Any]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(table)
    return text.getvalue().encode("utf-8", "backslashreplace")
