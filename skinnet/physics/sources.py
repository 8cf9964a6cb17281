"""Light and camera sources: by name, or measured and read from a CSV file."""

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

_MEAN = "mean"
"""Name of the mean of the measured cameras."""

_DAYLIGHT = re.compile(r"[dD](\d{2}|\d{4,5}\s*[kK]?)$")
_TEMPERATURES = (4000.0, 25000.0)


def load_light(name: str) -> Float[Tensor, "wavelength"]:
    """Load the relative power of a light at the 33 bands.

    Args:
        name: D65, D50 or another daylight (D5500K), a CIE illuminant of `LIGHTS`, or the path of a
            .csv file of wavelength in nm and power.

    Returns:
        Power of unit sum, float64.

    Raises:
        InputError: For an unknown name, with the names closest to it, and for a file that does not
            hold a spectrum.

    Source:
        CIE 015:2018; e of section 3.5 of Alotaibi & Smith 2017.

    Example:
        >>> from skinnet.physics import load_light
        >>> light = load_light("D65")
        >>> tuple(light.shape), round(light.sum().item(), 6)
        ((33,), 1.0)
    """
    if name.lower().endswith(".csv"):
        power = _read_spectra(Path(name), 1)[:, 0]
        return power / power.sum()
    if (day := _DAYLIGHT.match(name)) is not None:
        return _load_daylight(name, day.group(1))
    power = _find(name, read_table("illuminants"), "light", "D65 or another daylight, or ")
    return power / power.sum()


def load_camera(name: str) -> Float[Tensor, "wavelength 3"]:
    """Load the sensitivities of a camera at the 33 bands.

    Args:
        name: One of the 52 measured cameras in any case, `mean`, or the path of a .csv file of
            wavelength in nm and three sensitivities.

    Returns:
        Sensitivities of R, G and B, each of unit sum, float64.

    Raises:
        InputError: For an unknown name, with the names closest to it, and for a file that does not
            hold spectra.

    Source:
        S of section 3.5 of Alotaibi & Smith 2017, who used the Nikon D200.

    Example:
        >>> from skinnet.physics import load_camera
        >>> tuple(load_camera("nikon d200").shape)
        (33, 3)
    """
    if name.lower().endswith(".csv"):
        curves = _read_spectra(Path(name), 3)
        return curves / curves.sum(0)
    measured = load_cameras()
    if name.lower() == _MEAN:
        return torch.stack(list(measured.values())).mean(0)
    return _find(name, measured, "camera", f"{_MEAN}, or ")


def load_spectrum_to_srgb(light: str, camera: str) -> Float[Tensor, "wavelength 3"]:
    """Load the matrix from a spectrum to white-balanced linear sRGB under a light and a camera.

    Args:
        light: Name or file, as of `load_light`.
        camera: Name or file, as of `load_camera`.

    Returns:
        The matrix; a spectrum times it is linear sRGB. float64.

    Raises:
        InputError: As `load_light` and `load_camera`.

    Source:
        Equation 4 and section 4.3 of Alotaibi & Smith 2017; see `spectrum_to_srgb`.

    Example:
        >>> from skinnet.physics import load_spectrum_to_srgb
        >>> matrix = load_spectrum_to_srgb("LED-B3", "Nikon D200")
        >>> [round(value, 6) for value in matrix.sum(0).tolist()]  # white
        [1.0, 1.0, 1.0]
    """
    return spectrum_to_srgb(load_light(light), load_camera(camera), load_observer())


def _find(
    name: str, known: Mapping[str, Tensor], kind: str, others: str
) -> Float[Tensor, "wavelength *channels"]:
    folded = {each.casefold(): each for each in known}
    if name.casefold() in folded:
        return known[folded[name.casefold()]]
    close = difflib.get_close_matches(name.casefold(), folded, 3, 0.4)
    listed = [folded[each] for each in close] or sorted(known)[:5]
    raise InputError(
        f"There is no {kind} {name!r}; known are {others}{', '.join(listed)} and others, or give a "
        ".csv file."
    )


def _load_daylight(name: str, number: str) -> Float[Tensor, "wavelength"]:
    digits = float(number.rstrip("kK "))
    # CIE's two-digit names are older than today's value of c2 in Planck's law.
    kelvin = 100 * digits * 1.4388 / 1.438 if digits < 100 else digits
    if not _TEMPERATURES[0] <= kelvin <= _TEMPERATURES[1]:
        raise InputError(
            f"Daylight has {_TEMPERATURES[0]:g} to {_TEMPERATURES[1]:g} K; got {name!r}."
        )
    return daylight(torch.tensor(kelvin, dtype=torch.float64))


def _read_spectra(path: Path, columns: int) -> Float[Tensor, "wavelength columns"]:
    """Read the columns of a CSV at the 33 bands, interpolated linearly."""
    rows = _read_numbers(path, columns)
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


def _read_numbers(path: Path, columns: int) -> Float[np.ndarray, "rows columns"]:
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
