"""The file of a dynamic model."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.appearance._array_file import (
    ARCHIVE_ERRORS,
    make_damage_error,
    read_arrays,
    write_arrays,
)

SHIPPED = Path(__file__).parent / "models" / "dynamic.npz"
"""The model that is used by default; `python -m train.dynamic` makes it."""

FIELD_SIZE = 48
"""Side of the fields of a model in texels."""

ARRAYS = ("mean", "spread", "landmarks", "seconds")

_KIND = "DynamicModel"

Arrays = dict[str, NDArray[np.float32]]


def write_model(path: Path, header: dict[str, Any], arrays: Arrays) -> None:
    """Write a model, all of it or nothing.

    Raises:
        InputError: The path does not end in .npz or cannot be written.
    """
    write_arrays(path, _KIND, header, dict(arrays), compress=True)


def read_model(path: Path | None) -> tuple[dict[str, Any], Arrays]:
    """Read the header and the arrays of a model; None is the shipped one.

    Raises:
        InputError: The file is missing, damaged or of another kind.
    """
    file = SHIPPED if path is None else path
    found, arrays = read_arrays(file, _KIND, ARRAYS)
    try:
        header = {
            "names": tuple(str(name) for name in found["names"]),
            "states": {name: _read_numbers(each) for name, each in found["states"].items()},
            "sources": {name: str(source) for name, source in found["sources"].items()},
            "errors": _read_numbers(found["errors"]),
            "window": float(found["window"]),
        }
        values = {name: np.asarray(arrays[name], np.float32) for name in ARRAYS}
    except ARCHIVE_ERRORS as error:
        raise make_damage_error(file) from error
    if not _is_sound(header, values):
        raise make_damage_error(file)
    return header, values


def _read_numbers(record: dict[str, Any]) -> dict[str, int | float]:
    if not all(isinstance(number, int | float) for number in record.values()):
        raise ValueError("a number is none")
    return dict(record)


def _is_sound(header: dict[str, Any], arrays: Arrays) -> bool:
    count, size = len(header["names"]), arrays["mean"].shape[-1:]
    if not count or size < (1,) or not 0 < header["window"] < 1:
        return False
    shapes = [arrays[name].shape for name in ARRAYS]
    fits = shapes == [(count, *size, *size), (count, *size, *size), (478, 2), (count,)]
    used = {name for each in header["states"].values() for name in each}
    shares = [share for each in header["states"].values() for share in each.values()]
    finite = all(np.isfinite(each).all() for each in arrays.values())
    return fits and used <= {*header["names"]} and finite and bool(np.isfinite(shares).all())
