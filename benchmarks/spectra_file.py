"""Spectra of skin from a file with the columns of ISSA's: row, label, and each band."""

import csv
import math
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics import WAVELENGTHS

COLUMNS = ["row", "label", *(f"{nm:g}" for nm in WAVELENGTHS.tolist())]


def read_spectra(path: Path) -> Float[Tensor, "record wavelength"]:
    """Read reflectance at the bands of `WAVELENGTHS`; NaN where a cell is empty or 0.

    Raises:
        InputError: The file is absent or has other columns, or a value is no reflectance.
    """
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path} cannot be read as a table of spectra: {error}.") from error
    rows = [row for row in rows if row and not row[0].startswith("#")]
    if len(rows) < 2 or rows[0] != COLUMNS:
        raise InputError(
            f"{path} has no spectra under the columns row, label, 400, 410, ... 720; give it these."
        )
    return torch.tensor([_read_row(path, row) for row in rows[1:]], dtype=torch.float64)


def _read_row(path: Path, row: list[str]) -> list[float]:
    if len(row) != len(COLUMNS):
        raise InputError(f"Row {row[0]} of {path} has {len(row)} cells; it has {len(COLUMNS)}.")
    values = [_read_value(path, row[0], cell) for cell in row[2:]]
    if sum(map(math.isnan, values)) > len(values) // 2 or math.isnan(values[0]):
        raise InputError(
            f"Row {row[0]} of {path} lacks 400 nm or most bands; leave it out: its colour is not "
            "known."
        )
    return values


def _read_value(path: Path, row: str, cell: str) -> float:
    try:
        value = float(cell or 0)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise InputError(
            f"Row {row} of {path} has the value {cell!r}; reflectance is a number in [0, 1]. "
            "Is it in percent?"
        )
    return value or math.nan
