"""Lights and cameras by name, or measured and handed in as CSV."""

import csv
import difflib
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._tables import read_table
from skinnet.physics.camera import spectrum_to_srgb
from skinnet.physics.illuminants import daylight
from skinnet.physics.spectra import WAVELENGTHS, load_cameras, load_observer

MEAN = "mean"
"""Name of the mean of the measured cameras."""

DAYLIGHT = re.compile(r"[dD](\d{2}|\d{4,5}\s*[kK]?)$")
TEMPERATURES = (4000.0, 25000.0)


def load_light(name: str) -> Float[Tensor, "wavelength"]:
    """Relative power of a light [33], of unit sum, float64.

    `name` is D65, D50 or another daylight (D5500K), a CIE illuminant of `skinnet.physics`, or a
    .csv file of wavelength in nm and power. Raises `InputError` for an unknown name, with those
    that are near it, and for a file that does not hold a spectrum.
    """
    if name.lower().endswith(".csv"):
        power = _spectra(Path(name), 1)[:, 0]
        return power / power.sum()
    if (day := DAYLIGHT.match(name)) is not None:
        return _daylight(name, day.group(1))
    power = _named(name, read_table("illuminants"), "light", "D65 or another daylight, or ")
    return power / power.sum()


def load_camera(name: str) -> Float[Tensor, "wavelength 3"]:
    """Sensitivities of a camera [33, 3], R, G, B, each of unit sum, float64.

    `name` is one of the 52 measured cameras, `mean`, or a .csv file of wavelength in nm and three
    sensitivities. Raises `InputError` as `load_light` does.
    """
    if name.lower().endswith(".csv"):
        curves = _spectra(Path(name), 3)
        return curves / curves.sum(0)
    measured = load_cameras()
    if name.lower() == MEAN:
        return torch.stack(list(measured.values())).mean(0)
    return _named(name, measured, "camera", f"{MEAN}, or ")


def load_spectrum_to_srgb(light_name: str, camera_name: str) -> Float[Tensor, "wavelength 3"]:
    """The map from a spectrum [33] to white-balanced linear sRGB under a light and a camera."""
    return spectrum_to_srgb(load_light(light_name), load_camera(camera_name), load_observer())


def _named(
    name: str, known: Mapping[str, Tensor], kind: str, others: str
) -> Float[Tensor, "wavelength *channels"]:
    folded = {each.casefold(): each for each in known}
    if name.casefold() in folded:
        return known[folded[name.casefold()]]
    near = difflib.get_close_matches(name.casefold(), folded, 3, 0.4)
    shown = [folded[each] for each in near] or sorted(known)[:5]
    raise InputError(
        f"There is no {kind} {name!r}; known are {others}{', '.join(shown)} and others, or give a "
        ".csv file."
    )


def _daylight(name: str, number: str) -> Float[Tensor, "wavelength"]:
    digits = float(number.rstrip("kK "))
    # CIE's two-digit names are older than today's value of c2 in Planck's law.
    kelvin = 100 * digits * 1.4388 / 1.438 if digits < 100 else digits
    if not TEMPERATURES[0] <= kelvin <= TEMPERATURES[1]:
        raise InputError(
            f"Daylight has {TEMPERATURES[0]:g} to {TEMPERATURES[1]:g} K; got {name!r}."
        )
    return daylight(torch.tensor(kelvin, dtype=torch.float64))


def _spectra(path: Path, columns: int) -> Float[Tensor, "wavelength columns"]:
    """Columns of a CSV at the 33 bands, interpolated linearly."""
    rows = _numbers(path, columns)
    order = np.argsort(rows[:, 0], kind="stable")
    wavelength, values = rows[order, 0], rows[order, 1:]
    low, high = float(WAVELENGTHS[0]), float(WAVELENGTHS[-1])
    if len(wavelength) < 2 or wavelength[0] > low or wavelength[-1] < high:
        raise InputError(
            f"{path} covers {wavelength[0]:g} to {wavelength[-1]:g} nm; {low:g} to {high:g} nm are "
            "needed."
        )
    if (np.diff(wavelength) <= 0).any():
        raise InputError(f"{path} has a wavelength twice; keep one row for each.")
    bands = WAVELENGTHS.numpy()
    curves = np.stack([np.interp(bands, wavelength, column) for column in values.T], 1)
    if not (curves.sum(0) > 0).all():
        raise InputError(f"{path} has a column that is zero from {low:g} to {high:g} nm.")
    return torch.from_numpy(curves)


def _numbers(path: Path, columns: int) -> Float[np.ndarray, "rows columns"]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as a text file; check the path.") from error
    rows = [row for row in csv.reader(text.splitlines()) if row and not row[0].startswith("#")]
    body = rows[1:] if rows and not _is_number(rows[0][0]) else rows
    try:
        numbers = np.array(body, float)
    except ValueError as error:
        raise InputError(
            f"{path} has a row that is not {columns + 1} numbers: wavelength in nm, then "
            f"{columns} {'value' if columns == 1 else 'values'}."
        ) from error
    if numbers.ndim != 2 or numbers.shape[1] != columns + 1:
        raise InputError(
            f"{path} needs {columns + 1} columns: wavelength in nm, then {columns} "
            f"{'value' if columns == 1 else 'values'}."
        )
    if not np.isfinite(numbers).all() or (numbers[:, 1:] < 0).any():
        raise InputError(f"{path} has a value that is negative or not finite.")
    return numbers


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
