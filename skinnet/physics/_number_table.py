"""Tables of numbers in text files, as instruments, spreadsheets and people write them."""

import codecs
import csv
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.files._reading import MOST_TEXT, read_file

_NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_UNIT = re.compile(r"(?<=\d)\s*(?:nm|%)$")
_COMMENT = re.compile(r"\s*\"?\s*(?:[#%!]|//)")
_BLANK = frozenset(("", "-", "--", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf"))
_SEPARATORS = (";", "\t", ",", None)
"""What may stand between two fields, the likeliest first; None is any white space."""

_FOREIGN = (
    (re.compile(rb"PK\x03\x04|\xd0\xcf\x11\xe0"), "a spreadsheet or an archive"),
    (re.compile(rb"%PDF"), "a PDF"),
    (re.compile(rb"MATLAB|\x89HDF"), "a MATLAB or HDF5 file"),
    (re.compile(rb"(?:\xef\xbb\xbf)?\s*<"), "an XML or HTML file"),
    (re.compile(rb"(?:\xef\xbb\xbf)?\s*\{"), "a JSON file"),
    (re.compile(rb"IESNA"), "a photometric file without a spectrum"),
    (
        re.compile(rb"(?s)\s*(?:CGATS|CTI\d|SPECT\s|SPMEAS|IT8|ISO28178)|.*BEGIN_DATA"),
        "a CGATS file (as Argyll's .sp and .ti3)",
    ),
)
"""How files begin that are not read, and what they are."""


class NumberTable(NamedTuple):
    """Rows of numbers, NaN where a cell is blank, with their line numbers and the lines above."""

    values: Float[np.ndarray, "rows columns"]
    lines: list[int]
    header: list[str]

    def find_headings(self) -> list[list[str]]:
        """Find the lines of the header that have one name, or one unit, for each column."""
        count = self.values.shape[1]
        return [names for line in self.header if (names := _split_header(line, count))]


def read_number_table(path: Path, columns: int, needed: str) -> NumberTable:
    """Read the one table of numbers in a text file, by its content and not by its ending.

    Fields are separated by semicolons, tabs, commas or white space; decimals have a point or a
    comma. Lines above and below the table, and comments in it, are passed over.

    Args:
        path: The file.
        columns: How many columns it has to have; part of the error message.
        needed: What the table has to be; part of the error message.

    Returns:
        The table, without its blank columns. The header is empty where there is none.

    Raises:
        InputError: The file cannot be read, is of another kind, or has no table, a line in its
            table that is no row, or numbers that can be read in two ways.
    """
    lines = _read_text(path, needed).splitlines()
    separator, first = _find_table(lines)
    if first is None:
        raise InputError(f"{path} has no table of numbers; it {needed}.")
    rows, numbers = [], []
    ended = None
    for number, line in enumerate(lines[first:], first + 1):
        fields = _split(line, separator)
        if not any(fields) or _COMMENT.match(line):
            continue
        if not _is_number(fields[0]):
            ended = ended or number
        elif ended is not None or not _is_row(fields):
            raise InputError(
                f"{path}, line {ended or number}: {lines[(ended or number) - 1].strip()[:60]!r} is "
                f"not {columns} numbers; the file {needed}."
            )
        else:
            rows.append(fields)
            numbers.append(number)
    header = [line.strip().lstrip("#%!/ ") for line in lines[:first] if line.strip()]
    return _make_table(path, rows, numbers, header)


def _make_table(
    path: Path, rows: list[list[str]], lines: list[int], header: list[str]
) -> NumberTable:
    width = max(len(row) for row in rows)
    padded = [row + [""] * (width - len(row)) for row in rows]
    cells = [list(column) for column in zip(*padded, strict=True)]
    cells = [column for column in cells if any(column)]
    _check_decimals(path, cells)
    values = [[_parse(cell) for cell in column] for column in cells]
    return NumberTable(np.array(values, np.float64).T, lines, header)


def _check_decimals(path: Path, columns: list[list[str]]) -> None:
    """Refuse commas that may separate thousands as well as decimals."""
    with_comma = [cell for column in columns for cell in column if "," in cell]
    mixed = with_comma and any("." in cell for column in columns for cell in column)
    for column in columns:
        commas = [cell for cell in column if "," in cell]
        plain = [cell for cell in column if "," not in cell and _is_number(cell)]
        mixed = mixed or (commas and plain and all(_THOUSANDS.fullmatch(one) for one in commas))
    if mixed:
        raise InputError(
            f"{path} has numbers such as {with_comma[0]!r} whose comma may stand before decimals "
            "or thousands; write them all with a decimal point."
        )


def _read_text(path: Path, needed: str) -> str:
    try:
        data = read_file(path, MOST_TEXT)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as a text file; check the path.") from error
    kind = next((name for start, name in _FOREIGN if start.match(data)), None)
    if kind is not None:
        raise InputError(f"{path} is {kind}; export the table as CSV. It {needed}.")
    encoding = _guess_encoding(data)
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        raise InputError(f"{path} cannot be read as a text file; check the path.") from error


def _guess_encoding(data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if b"\0" in data[:2]:
        return "utf-16-le" if data[1:2] == b"\0" else "utf-16-be"
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        # Instruments write degrees and micrometres in the code page of western Windows.
        return "ascii" if b"\0" in data else "latin-1"
    return "utf-8-sig"


def _find_table(lines: list[str]) -> tuple[str | None, int | None]:
    """Find the separator with which most lines are rows of numbers, and the first such line."""
    best: tuple[int, str | None, int | None] = (0, None, None)
    for separator in _SEPARATORS:
        found = [
            index
            for index, line in enumerate(lines)
            if not _COMMENT.match(line)
            and _is_row(fields := _split(line, separator))
            and sum(map(_is_number, fields)) > 1
        ]
        if len(found) > best[0]:
            best = (len(found), separator, found[0])
    _, separator, first = best
    # A table may begin with a row whose values are missing, which has to be refused.
    while first and _is_row(fields := _split(lines[first - 1], separator)) and len(fields) > 1:
        first -= 1
    return separator, first


def _split(line: str, separator: str | None) -> list[str]:
    if separator is None:
        fields = line.replace('"', " ").split()
    else:
        try:
            fields = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:  # a field of more than 131,072 characters
            fields = []
    return [_UNIT.sub("", field.strip()) for field in fields] or [""]


def _split_header(line: str, count: int) -> list[str] | None:
    """Split a line above the table into that many names, by whatever separates them."""
    for separator in _SEPARATORS:
        names = [name for name in (_split(line, separator)) if name]
        if len(names) == count:
            return names
    return None


def _is_row(fields: list[str]) -> bool:
    return _is_number(fields[0]) and all(
        _is_number(field) or field.lower() in _BLANK for field in fields
    )


def _is_number(text: str) -> bool:
    return _NUMBER.fullmatch(text) is not None


def _parse(cell: str) -> float:
    return float(cell.replace(",", ".")) if _is_number(cell) else float("nan")
