"""Spectra of lights and cameras in text files, averaged over the 33 bands."""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.physics._band_averages import average_over_bands
from skinnet.physics._number_table import NumberTable, read_number_table
from skinnet.physics.spectra import WAVELENGTHS

_SHORT = 0.5
"""Nanometres by which the first and the last row may miss the first and the last band."""

_NOISE = 0.01
"""Share of the sum of the bands that negative bands may have; dark noise is below."""

_WIDEST_GAP = 40.0
"""Nanometres between two rows that are interpolated; what lies in a wider gap is not known."""

_GLITCH = 0.05
"""Share of the largest value beyond which a negative value is no noise."""

_OVERLAP = 5.0
"""Nanometres by which red's mean wavelength may lie below green's, or green's below blue's."""

_WAVELENGTH = re.compile(r"wave|lambda|λ|wellen|longueur|longitud|^\W*(?:nm|um|µm|μm|Å)\W*$", re.I)
_NO_WAVELENGTH = re.compile(r"wave\W*num|cm\W*-\W*1|1/cm|cm⁻¹|\bt?hz\b|frequency|\bev\b", re.I)
_PHOTONS = re.compile(r"photon|\bquant|[uµμ]mol|\bqe\b|\bppfd?\b", re.I)

_UNITS = (
    ("nm", 1.0, re.compile(r"\bnm\b|_nm|nanomet", re.I)),
    ("micrometres", 1e3, re.compile(r"[µμ]m|\b_?um\b|_um|micro", re.I)),
    ("Angstrom", 0.1, re.compile(r"Å|ngstr", re.I)),
    ("metres", 1e9, re.compile(r"[\[(/]\s*m\s*[\])]?\s*$|\bmet(?:er|re)s?\b", re.I)),
)
"""Units of wavelength: name, size in nm, and how a heading states it."""

_CHANNELS = (
    ("r", "red", "rot", "rouge", "rojo", "rosso"),
    ("g", "green", "grün", "gruen", "vert", "verde"),
    ("b", "blue", "blau", "bleu", "azul", "blu"),
)


def read_light(path: Path) -> Float[np.ndarray, "bands"]:
    """Read the power of a light at the 33 bands, times any factor, from a file."""
    needed = "needs 2 columns, one row for each wavelength: wavelength in nm, then 1 value"
    table = read_number_table(path, 2, needed)
    bands, _ = _average(path, table, 1, needed)
    return bands[:, 0]


def read_camera(path: Path) -> Float[np.ndarray, "bands 3"]:
    """Read R, G and B of a camera at the 33 bands, each times any factor, from a file."""
    needed = (
        "needs 4 columns, one row for each wavelength: wavelength in nm, then 3 values, of R, G "
        "and B"
    )
    table = read_number_table(path, 4, needed)
    bands, names = _average(path, table, 3, needed)
    order = _order_channels(path, names)
    _check_order(path, bands[:, order])
    return bands[:, order]


def _average(
    path: Path, table: NumberTable, count: int, needed: str
) -> tuple[Float[np.ndarray, "bands columns"], list[str]]:
    """Average the columns of values over the bands; their names, if the header gives them."""
    # A line of names, and perhaps one of units; the lines above are about the instrument.
    headings = table.find_headings()[-2:]
    names = [" ".join(dict.fromkeys(parts)) for parts in zip(*headings, strict=True)]
    if table.values.shape[1] != count + 1:
        stated = f", {', '.join(names)}" if names else ""
        raise InputError(f"{path} {needed}. It has {table.values.shape[1]} columns{stated}.")
    first = next((i for i, name in enumerate(names) if _WAVELENGTH.search(name)), 0)
    others = [i for i in range(count + 1) if i != first]
    last = " ".join(table.header[-1:])
    stated = names[first] if names else last
    _check_headings(path, stated, [names[i] for i in others] if names else [last])
    _check_finite(path, table)
    wavelength = _convert_wavelengths(path, table.values[:, first], names[first] if names else "")
    order = _check_wavelengths(path, wavelength)
    values = table.values[:, others]
    # Only the shape counts, and the sum of the largest floats would be infinite.
    values = values / np.abs(values).max(0).clip(np.finfo(float).tiny)
    bands = average_over_bands(wavelength[order], values[order], WAVELENGTHS.numpy())
    clipped = _clip_noise(path, bands, values)
    _check_gaps(path, wavelength[order])
    return clipped, [names[i] for i in others if names]


def _check_headings(path: Path, wavelength: str, values: list[str]) -> None:
    if _NO_WAVELENGTH.search(wavelength):
        raise InputError(
            f"{path} has a column {wavelength!r}; convert it to wavelengths in nm, and the values "
            "to power per nm."
        )
    photons = next((name for name in values if _PHOTONS.search(name)), None)
    if photons is not None:
        raise InputError(
            f"{path} has a column {photons!r}, which counts photons; convert it to power (photons "
            "divided by wavelength), and a camera's quantum efficiency to sensitivity to power "
            "(efficiency times wavelength)."
        )


def _check_finite(path: Path, table: NumberTable) -> None:
    bad = ~np.isfinite(table.values).all(1)
    if bad.any():
        raise InputError(
            f"{path}, line {table.lines[int(bad.argmax())]}, has a value that is missing, negative "
            "or not finite; complete the row or remove it."
        )


def _convert_wavelengths(
    path: Path, wavelength: Float[np.ndarray, "rows"], heading: str
) -> Float[np.ndarray, "rows"]:
    """Convert to nm, from the unit in which the wavelengths cover the bands."""
    stated = [name for name, _, words in _UNITS if words.search(heading)]
    low, high = float(WAVELENGTHS[0]) + _SHORT, float(WAVELENGTHS[-1]) - _SHORT
    for name, size, _ in _UNITS:
        if size * wavelength.min() <= low and size * wavelength.max() >= high:
            if stated and name not in stated:
                raise InputError(
                    f"{path} states {heading!r}, but its wavelengths, {wavelength.min():g} to "
                    f"{wavelength.max():g}, look like {name}; give them in nm."
                )
            return size * wavelength
    size = next((size for name, size, _ in _UNITS if name in stated), 1.0)
    raise InputError(
        f"{path} covers {size * wavelength.min():g} to {size * wavelength.max():g} nm; 400 to 720 "
        "nm are needed. Extend the table where its values are known."
    )


def _check_wavelengths(path: Path, wavelength: Float[np.ndarray, "rows"]) -> slice:
    """Check that the wavelengths go one way; the order in which they ascend."""
    steps = np.diff(wavelength)
    if (steps == 0).any():
        twice = wavelength[:-1][steps == 0][0]
        raise InputError(
            f"{path} has a wavelength twice, {twice:g} nm; keep one row for each, of one spectrum."
        )
    if not ((steps > 0).all() or (steps < 0).all()):
        turn = wavelength[1:-1][np.sign(steps[1:]) != np.sign(steps[:-1])][0]
        raise InputError(
            f"{path} has wavelengths that go up and down, at {turn:g} nm; keep the rows of one "
            "spectrum, in order."
        )
    return slice(None, None, 1 if steps[0] > 0 else -1)


def _check_gaps(path: Path, wavelength: Float[np.ndarray, "rows"]) -> None:
    """Refuse tables with a gap that a line or a band may hide in; `wavelength` ascends."""
    low, high = float(WAVELENGTHS[0]), float(WAVELENGTHS[-1])
    wide = (np.diff(wavelength) > _WIDEST_GAP) & (wavelength[1:] > low) & (wavelength[:-1] < high)
    if wide.any():
        at = int(wide.argmax())
        raise InputError(
            f"{path} has no row between {wavelength[at]:g} and {wavelength[at + 1]:g} nm; rows at "
            f"most {_WIDEST_GAP:g} nm apart are needed. Complete the table."
        )


def _clip_noise(
    path: Path, bands: Float[np.ndarray, "bands columns"], values: Float[np.ndarray, "rows columns"]
) -> Float[np.ndarray, "bands columns"]:
    """Set bands below 0 to 0 where they are dark noise, and refuse other negative values."""
    clipped = bands.clip(0)
    if not (clipped.sum(0) > 0).all():
        raise InputError(f"{path} has a column that is zero from 400 to 720 nm.")
    missing = (clipped - bands).sum(0)
    if (values.min(0) < -_GLITCH * values.max(0)).any() or (
        missing > _NOISE * clipped.sum(0)
    ).any():
        raise InputError(
            f"{path} has a value that is negative or not finite, {values.min():.2g} of the "
            "largest, which is more than noise; subtract the dark spectrum, or set it to 0."
        )
    return clipped


def _order_channels(path: Path, names: list[str]) -> list[int]:
    """Find the columns of red, green and blue by name; without names they have that order."""
    if not names:
        return [0, 1, 2]
    channels = [_find_channel(name) for name in names]
    if sorted(channels) != [0, 1, 2]:
        raise InputError(
            f"{path} has columns {', '.join(names)}, and a camera's are red, green and blue; name "
            "them r, g and b."
        )
    return [channels.index(channel) for channel in range(3)]


def _find_channel(name: str) -> int:
    """Find the one channel that a heading names; -1 for none or several."""
    words = re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name))
    found = {
        index
        for index, (letter, *long) in enumerate(_CHANNELS)
        for word in map(str.casefold, words)
        if word == letter or word.startswith(tuple(long))
    }
    return found.pop() if len(found) == 1 else -1


def _check_order(path: Path, bands: Float[np.ndarray, "bands 3"]) -> None:
    means = WAVELENGTHS.numpy() @ bands / bands.sum(0)
    if (np.diff(means) > _OVERLAP).any():
        stated = ", ".join(f"{one:.0f}" for one in means)
        raise InputError(
            f"{path} has columns whose mean wavelengths are {stated} nm, and those of red, green "
            "and blue descend; put the columns into that order and name them r, g and b."
        )
