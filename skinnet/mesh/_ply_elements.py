"""Elements of PLY files: their properties as columns, in text and in binary."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from skinnet.mesh._obj_lines import convert
from skinnet.mesh._ply_header import PlyElement, PlyHeader, refuse_ply


class Column(NamedTuple):
    """A property of all elements of a kind: values in one row, and how many each element has."""

    values: np.ndarray
    counts: np.ndarray


Columns = dict[str, dict[str, Column]]
"""Columns by the names of elements and properties."""


def read_elements(path: Path, header: PlyHeader, body: bytes) -> Columns:
    """Read all elements of a PLY file.

    Raises:
        InputError: If the file is shorter than its header states, or has a word among its numbers.
    """
    source = _Text(path, body) if header.order == "" else _Binary(path, body, header.order)
    return {element.name: _read_element(source, element) for element in header.elements}


class _Text:
    """Numbers as words; all are converted at once."""

    def __init__(self, path: Path, body: bytes) -> None:
        self.path, self.place = path, 0
        self.values = convert(body, np.float64)
        if body.strip() and not len(self.values):
            raise refuse_ply(path, "it has a word where a number belongs")

    def take(self, kind: str, count: int) -> np.ndarray:
        values = self.values[self.place : self.place + count]
        self.place += count
        return values

    def take_table(self, element: PlyElement, sizes: list[int]) -> list[np.ndarray] | None:
        width = sum(sizes)
        rows = self.values[self.place : self.place + width * element.length]
        if len(rows) < width * element.length:
            return None
        self.place += len(rows)
        ends = np.cumsum(sizes)[:-1]
        return list(np.split(rows.reshape(element.length, width), ends, axis=1))

    def is_over(self) -> bool:
        return self.place > len(self.values)


class _Binary:
    """Numbers in binary."""

    def __init__(self, path: Path, body: bytes, order: str) -> None:
        self.path, self.body, self.order, self.place = path, body, order, 0

    def take(self, kind: str, count: int) -> np.ndarray:
        dtype = np.dtype(self.order + kind)
        size = count * dtype.itemsize
        values = np.frombuffer(self.body[self.place : self.place + size][:size], "u1")
        self.place += size
        whole = len(values) // dtype.itemsize
        return values[: whole * dtype.itemsize].view(dtype)

    def take_table(self, element: PlyElement, sizes: list[int]) -> list[np.ndarray] | None:
        kinds = [
            kind
            for one in element.properties
            for kind in ([one.length, one.kind] if one.length else [one.kind])
        ]
        fields = [
            (str(place), self.order + kind, (size,))
            for place, (kind, size) in enumerate(zip(kinds, sizes, strict=True))
        ]
        dtype = np.dtype(fields)
        size = dtype.itemsize * element.length
        if self.place + size > len(self.body):
            return None
        rows = np.frombuffer(self.body, dtype, element.length, self.place)
        self.place += size
        return [rows[str(place)] for place in range(len(fields))]

    def is_over(self) -> bool:
        return self.place > len(self.body)


_Source = _Text | _Binary


def _read_element(source: _Source, element: PlyElement) -> dict[str, Column]:
    start = source.place
    sizes = _read_row(source, element)[1] if element.length else _empty_sizes(element)
    source.place = start
    table = source.take_table(element, sizes)
    if table is not None:
        columns = _name_columns(element, table, sizes)
        if columns is not None:
            return columns
    source.place = start
    return _read_rows(source, element)


def _empty_sizes(element: PlyElement) -> list[int]:
    return [1 for one in element.properties for _ in range(2 if one.length else 1)]


def _read_row(source: _Source, element: PlyElement) -> tuple[list[np.ndarray], list[int]]:
    """Read the values of one element, and the sizes of its fields, with those of lengths."""
    values, sizes = [], []
    for one in element.properties:
        length = 1
        if one.length:
            stated = source.take(one.length, 1)
            length = int(stated[0]) if len(stated) and stated[0] >= 0 else 0
            sizes.append(1)
        values.append(source.take(one.kind, length))
        sizes.append(length)
    if source.is_over():
        what = f"{element.length:,} elements {element.name!r}"
        raise refuse_ply(source.path, f"it ends before all of its {what}")
    return values, sizes


def _name_columns(
    element: PlyElement, table: list[np.ndarray], sizes: list[int]
) -> dict[str, Column] | None:
    """Name the columns of elements that all have lists of the lengths of the first."""
    columns, place = {}, 0
    for one in element.properties:
        if one.length:
            if (table[place] != sizes[place + 1]).any():
                return None
            place += 1
        counts = np.full(element.length, sizes[place])
        columns[one.name] = Column(table[place].reshape(-1), counts)
        place += 1
    return columns


def _read_rows(source: _Source, element: PlyElement) -> dict[str, Column]:
    rows = [_read_row(source, element)[0] for _ in range(element.length)]
    return {
        one.name: Column(
            np.concatenate([row[place] for row in rows]),
            np.array([len(row[place]) for row in rows]),
        )
        for place, one in enumerate(element.properties)
    }
