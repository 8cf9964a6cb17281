"""The weights of an ONNX file, read without onnxruntime: numbers that a training may have found."""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.files._reading import read_file
from skinnet.inference._onnx_header import _read_fields

_GRAPH, _INITIALIZER = 7, 5
_TYPE, _FLOATS, _NAME, _RAW, _DOUBLES = 2, 4, 8, 9, 10
_DTYPES = {1: "<f4", 10: "<f2", 11: "<f8"}

_LARGEST = 1e5
"""Largest weight; those of the shipped models stay below a tenth of it."""

_UNKNOWN = "known_"
"""Start of the names of optional inputs, whose NaN means that nothing is known."""


def check_weights(path: Path, remedy: str) -> None:
    """Check that all weights of an ONNX file are numbers, and of a size that weights have.

    Args:
        path: The file.
        remedy: What to do if they are not.

    Raises:
        InputError: A weight is NaN, infinite, or larger than any that training finds.
    """
    for name, values in _list_weights(read_file(path)):
        if not name.startswith(_UNKNOWN):
            check_values(path, name, values, _LARGEST, remedy)


def check_values(path: Path, name: str, values: NDArray[Any], largest: float, remedy: str) -> None:
    """Raise `InputError` unless all values are numbers that are not larger than a limit."""
    with np.errstate(invalid="ignore"):
        # Half precision cannot hold the limit.
        wrong = ~(np.abs(values, dtype=np.promote_types(values.dtype, np.float32)) <= largest)
    if wrong.any():
        raise InputError(
            f"{path} has weights that are no weights of a trained model: {values[wrong][0]:g} in "
            f"{name}; {remedy}."
        )


def _list_weights(data: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
    for graph in _list_messages(data, _GRAPH):
        for tensor in _list_messages(graph, _INITIALIZER):
            yield from _read_tensor(tensor)


def _read_tensor(tensor: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
    """The floats of a tensor; none for integers, which cannot be out of place."""
    fields = list(_read_fields(BytesIO(tensor), len(tensor), len(tensor)))
    name = next((each.text for each in fields if each.number == _NAME), "")
    kind = next((each.integer for each in fields if each.number == _TYPE), 0)
    stored = {_RAW: _DTYPES.get(kind), _FLOATS: "<f4", _DOUBLES: "<f8"}
    for field in fields:
        dtype = stored.get(field.number)
        if dtype is not None:
            size = np.dtype(dtype).itemsize
            yield name, np.frombuffer(field.content, dtype, len(field.content) // size)


def _list_messages(data: bytes, number: int) -> Iterator[bytes]:
    fields = _read_fields(BytesIO(data), len(data), len(data))
    return (field.content for field in fields if field.number == number)
