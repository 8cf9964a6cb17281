"""Colour charts: the classic one of 24 patches, and a user's own from a CSV file."""

import csv
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_missing
from skinnet.inference._references.spectral_camera import BANDS, make_daylight_observer

Array = NDArray[np.float64]

CLASSIC = "classic"
"""Name of the ColorChecker Classic, whose patches the ColorChecker Passport has too."""

_COLUMNS = 6
_SPECTRA = "BabelColor Average"
"""Mean of measured charts in colour-science, 380 to 730 nm."""

_NEUTRAL = 1.12
"""Largest ratio of the channels of a neutral patch."""

_LEAST_PATCHES = 12
_COVERED = 420.0, 700.0
"""Wavelengths in nm that a patch's spectrum must cover; beyond, its ends are continued."""

_REMEDY = (
    "it needs the columns row and column, from 1, and either L, a and b (CIE L*a*b* under D50), or "
    "wavelengths in nm with reflectances in [0, 1]"
)


class Chart(NamedTuple):
    """A chart's patches.

    Attributes:
        name: How messages call the chart.
        cells: Column and row of each patch from 0 [n, 2].
        colours: Linear sRGB of each patch under D65 [n, 3]; a perfect white is 1.
        spectra: Reflectance of each patch at the 33 bands [n, 33]; None if it is not known.
    """

    name: str
    cells: Array
    colours: Array
    spectra: Array | None = None

    @property
    def neutral(self) -> NDArray[np.bool_]:
        """Which patches are white, grey or black [n]."""
        low, high = self.colours.min(1), self.colours.max(1)
        return np.asarray((high < _NEUTRAL * low) & (low > 0.02))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of columns and rows."""
        columns, rows = self.cells.max(0).astype(int) + 1
        return int(columns), int(rows)


def load_chart(name: str | Path) -> Chart:
    """Load a chart: `classic`, or the path of a CSV file.

    Raises:
        InputError: There is no such chart, or the file is not a chart; or colour-science is not
            installed.
    """
    if str(name) == CLASSIC:
        return _load_classic()
    path = Path(name)
    if path.suffix.lower() != ".csv":
        raise InputError(
            f"A chart is {CLASSIC} (the ColorChecker Classic and Passport), or a .csv file of its "
            f"patches; got {str(name)!r}."
        )
    return _read_csv(path)


def require_chart_extra() -> Any:
    """Import the detector of charts.

    Raises:
        InputError: It is not installed.
    """
    try:
        import colour_checker_detection
    except ImportError as error:
        raise _explain_missing(error, "chart", "A chart") from error
    return colour_checker_detection


def _load_classic() -> Chart:
    require_chart_extra()
    import colour

    patches = colour.SDS_COLOURCHECKERS[_SPECTRA].values()
    spectra = np.array([np.interp(BANDS, each.wavelengths, each.values) for each in patches])
    cells = np.array([(number % _COLUMNS, number // _COLUMNS) for number in range(len(spectra))])
    return Chart("classic chart", cells.astype(float), spectra @ make_daylight_observer(), spectra)


def _read_csv(path: Path) -> Chart:
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = [line for line in file if line.strip() and not line.startswith("#")]
    except FileNotFoundError:
        raise InputError(f"There is no chart {path}; give classic, or a CSV file.") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"The chart {path} cannot be read ({error}); check the path.") from error
    head, *rows = list(csv.reader(lines)) or [[]]
    names = [name.strip().lower() for name in head]
    values = {
        name: _read_column(path, names[at], [row[at : at + 1] for row in rows])
        for at, name in enumerate(names)
        if name != "name"
    }
    if not {"row", "column"} <= set(values):
        raise InputError(f"The chart {path} has the columns {', '.join(names)}; {_REMEDY}.")
    cells = np.stack([values["column"], values["row"]], 1) - 1
    _check_cells(path, cells)
    if {"l", "a", "b"} <= set(values):
        lab = np.stack([values[name] for name in "lab"], 1)
        return Chart(path.name, cells, _convert_lab(path, lab))
    spectra = _read_spectra(path, values)
    return Chart(path.name, cells, spectra @ make_daylight_observer(), spectra)


def _read_column(path: Path, name: str, cells: list[list[str]]) -> Array:
    numbers = []
    for line, cell in enumerate(cells, 2):
        try:
            number = float(cell[0])
        except (ValueError, IndexError):
            number = math.nan
        if not math.isfinite(number):
            got = cell[0] if cell else ""
            raise InputError(
                f"Row {line} of the chart {path} has {got!r} as its {name}; {_REMEDY}."
            )
        numbers.append(number)
    return np.array(numbers)


def _check_cells(path: Path, cells: Array) -> None:
    """Refuse what is no complete grid."""
    if len(cells) < _LEAST_PATCHES:
        raise InputError(
            f"The chart {path} has {len(cells)} patches, and {_LEAST_PATCHES} are needed."
        )
    columns, rows = cells.max(0) + 1
    whole = (cells == np.floor(cells)).all() and (cells >= 0).all()
    if not whole or len(np.unique(cells, axis=0)) != len(cells) or len(cells) != columns * rows:
        raise InputError(
            f"The chart {path} has {len(cells)} patches, which are not each cell of {rows:g} rows "
            f"and {columns:g} columns once."
        )


def _convert_lab(path: Path, lab: Array) -> Array:
    if not ((lab[:, 0] >= 0) & (lab[:, 0] <= 100)).all() or np.abs(lab[:, 1:]).max() > 150:
        raise InputError(
            f"The chart {path} has L*a*b* outside of L in [0, 100] and a and b in [-150, 150]."
        )
    require_chart_extra()
    import colour

    d50 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D50"]
    return np.asarray(colour.XYZ_to_RGB(colour.Lab_to_XYZ(lab, d50), "sRGB", d50))


def _read_spectra(path: Path, values: dict[str, Array]) -> Array:
    wavelengths = sorted(name for name in values if name.replace(".", "", 1).isdigit())
    wavelengths.sort(key=float)
    known = np.array([float(name) for name in wavelengths])
    if known.size < 2 or known[0] > _COVERED[0] or known[-1] < _COVERED[1]:
        raise InputError(f"The chart {path} has no colours; {_REMEDY}.")
    spectra = np.stack([values[name] for name in wavelengths], 1)
    if spectra.min() < 0 or spectra.max() > 1.2:
        raise InputError(
            f"The chart {path} has reflectances of {spectra.min():g} to {spectra.max():g}; they "
            "are shares in [0, 1]. Were they given in percent?"
        )
    return np.array([np.interp(BANDS, known, each) for each in spectra])
