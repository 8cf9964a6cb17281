"""Light and camera sources: by name, or measured and read from a text file."""

import difflib
import re
from collections.abc import Mapping
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._spectrum_file import read_camera, read_light
from skinnet.physics._tables import read_table
from skinnet.physics.camera import spectrum_to_srgb
from skinnet.physics.illuminants import daylight
from skinnet.physics.spectra import load_cameras, load_observer

_MEAN = "mean"
"""Name of the mean of the measured cameras."""

_OBSERVER = "observer"
"""Name of the CIE 1931 standard observer in place of a camera."""

_DAYLIGHT = re.compile(r"[dD](\d{2}|\d{4,5}\s*[kK]?)$")
_TEMPERATURES = (4000.0, 25000.0)
_FILE = re.compile(r"[/\\]|\.[A-Za-z]\w*$")
"""What a path has and no name: a slash, or an ending."""


def load_light(name: str | Path) -> Float[Tensor, "wavelength"]:
    """Load the relative power of a light at the 33 bands.

    Args:
        name: D65, D50 or another daylight (D5500K), a CIE illuminant of `LIGHTS`, or the path of a
            text file (.csv, .tsv, .txt) of wavelength in nm and power. Its rows may have any
            spacing; they are averaged over the bands of 10 nm, as the illuminants are. What of
            395 to 725 nm the file does not cover is left out; 400 to 720 nm are needed.

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
    if (path := _as_path(name)) is not None:
        power = torch.from_numpy(read_light(path))
        return power / power.sum()
    name = str(name)
    if (day := _DAYLIGHT.match(name)) is not None:
        return _load_daylight(name, day.group(1))
    power = _find(name, read_table("illuminants"), "light", "D65 or another daylight, or ")
    return power / power.sum()


def load_camera(name: str | Path) -> Float[Tensor, "wavelength 3"]:
    """Load the sensitivities of a camera at the 33 bands.

    Args:
        name: One of the 52 measured cameras in any case, `mean`, `observer` for the CIE 1931
            standard observer, whose colours are exactly sRGB, or the path of a text file of
            wavelength in nm and the sensitivities to power of R, G and B, which are averaged as
            `load_light` describes. Columns that the file names are taken by their names. The
            measured cameras are samples every 10 nm; colours from their tables of 5 nm differ by
            1 to 3 % under daylight.

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
    if (path := _as_path(name)) is not None:
        curves = torch.from_numpy(read_camera(path))
        return curves / curves.sum(0)
    name = str(name)
    measured = load_cameras()
    if name.lower() == _MEAN:
        return torch.stack(list(measured.values())).mean(0)
    if name.lower() == _OBSERVER:
        curves = load_observer()
        return curves / curves.sum(0)
    return _find(name, measured, "camera", f"{_MEAN}, {_OBSERVER}, or ")


def load_spectrum_to_srgb(light: str | Path, camera: str | Path) -> Float[Tensor, "wavelength 3"]:
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


def _as_path(name: str | Path) -> Path | None:
    return Path(name) if isinstance(name, Path) or _FILE.search(name) else None


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
        ".csv file of wavelengths and values."
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
