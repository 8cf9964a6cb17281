"""Light, camera and white balance at the 33 bands, in NumPy: `skinnet.physics.SpectralCamera`."""

import csv
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BANDS = np.arange(400.0, 721.0, 10.0)
"""The bands in nm."""

COMPONENTS = 6
"""Components of the camera basis."""

_PRIMARIES, _WHITE = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06)), (0.3127, 0.3290)
"""Chromaticities of sRGB and of its white (IEC 61966-2-1)."""

_UP_TO_7000_K = (-4.6070, 2.9678, 0.09911, 0.244063)
_ABOVE_7000_K = (-2.0064, 1.9018, 0.24748, 0.237040)
"""Coefficients of t^3, t^2, t and 1 in the chromaticity x of daylight, t = 1000 K / T."""


def list_lights() -> tuple[str, ...]:
    """List the names of the lights: daylight, then lamps."""
    return ("D", *_read_rows("illuminants")[0][1:])


def make_light(name: str, kelvin: float = 6504.0) -> Array:
    """Make the relative power [33] of a light; the temperature is that of daylight.

    Source:
        CIE 015:2018, equations 4.5 to 4.9, for daylight.
    """
    if name != "D":
        return _read_table("illuminants")[:, list_lights().index(name) - 1]
    t = 1000 / kelvin
    x = float(np.polyval(_UP_TO_7000_K if kelvin <= 7000 else _ABOVE_7000_K, t))
    y = -3 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    weights = 1, (-1.3515 - 1.7703 * x + 5.9114 * y) / m, (0.0300 - 31.4424 * x + 30.0717 * y) / m
    return np.asarray(_read_table("daylight") @ weights)


def make_sensitivity(coefficients: Array) -> Array:
    """Make the sensitivity [33, 3] of a camera from coefficients of the basis."""
    mean, *basis = _read_basis()
    return np.asarray(mean + np.tensordot(coefficients, np.array(basis), 1))


def make_matrix(light: Array, sensitivity: Array, balance: tuple[float, float]) -> Array:
    """Make the matrix [33, 3] from a spectrum to linear sRGB, as `spectrum_to_srgb` does.

    Source:
        Equation 4 of Alotaibi & Smith 2017; XYZ to sRGB by IEC 61966-2-1.
    """
    sensitivity = sensitivity / (light @ sensitivity)
    observer = _read_table("observer")
    observer = observer / observer.sum(0)
    to_xyz = np.linalg.lstsq(sensitivity, observer, rcond=None)[0]
    srgb = _make_srgb_to_xyz()
    to_xyz = to_xyz * (srgb.sum(1) / to_xyz.sum(0))
    to_srgb = to_xyz @ np.linalg.inv(srgb).T
    gain = np.exp((balance[0], 0.0, balance[1]))
    return np.asarray(light[:, None] * sensitivity * gain @ (to_srgb / to_srgb.sum(0)))


def make_daylight_observer() -> Array:
    """Make the matrix [33, 3] from a spectrum to the linear sRGB that D65 makes of it."""
    weighted = make_light("D")[:, None] * _read_table("observer")
    to_srgb = weighted @ np.linalg.inv(_make_srgb_to_xyz()).T
    return np.asarray(to_srgb / to_srgb.sum(0))


@cache
def _make_srgb_to_xyz() -> Array:
    """The matrix from linear sRGB to XYZ, not rounded."""
    x, y = np.transpose((*_PRIMARIES, _WHITE))
    xyz = np.stack([x / y, np.ones(4), (1 - x - y) / y])
    return np.asarray(xyz[:, :3] * np.linalg.solve(xyz[:, :3], xyz[:, 3]))


@cache
def _read_table(name: str) -> Array:
    return np.array(_read_rows(name)[1:], float)[:, 1:]


@cache
def _read_basis() -> Array:
    """Mean and components [7, 33, 3] of the measured cameras."""
    values = np.array([row[2:] for row in _read_rows("camera_basis")[1:]], float)
    return np.asarray(values.reshape(1 + COMPONENTS, 3, -1).swapaxes(1, 2))


def _read_rows(name: str) -> list[list[str]]:
    text = (files("skinnet") / "physics" / "tables" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
