"""Numbers that dermatology uses, as functions of a colour or of a spectrum of skin."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

BANDS = np.arange(400.0, 721.0, 10.0)
"""Wavelengths of a spectrum's bands in nm."""

GREEN, RED = 568.0, 655.0
"""Peaks in nm of the two light-emitting diodes of a DermaSpectrometer (Clarys et al. 2000)."""

TYPOLOGY_GROUPS = {
    "very_light": 55.0,
    "light": 41.0,
    "intermediate": 28.0,
    "tan": 10.0,
    "brown": -30.0,
    "dark": -180.0,
}
"""Lower ends in degrees (Chardon et al. 1991; Del Bino and Bernerd 2013)."""

_EDGE = 6 / 29


def compute_lab(xyz: ArrayLike) -> NDArray[np.float64]:
    """Compute CIE 1976 L*a*b*.

    Args:
        xyz: Tristimulus values [*shape, 3], each over that of white.

    Returns:
        L*, a* and b* [*shape, 3].

    Source:
        CIE 015:2018, section 8.2.1.
    """
    relative = np.asarray(xyz, np.float64)
    root = np.cbrt(np.maximum(relative, _EDGE**3))
    x, y, z = np.moveaxis(
        np.where(relative > _EDGE**3, root, relative / (3 * _EDGE**2) + 4 / 29), -1, 0
    )
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], -1)


def compute_typology_angle(lab: ArrayLike) -> NDArray[np.float64]:
    """Compute the individual typology angle, atan2(L* - 50, b*).

    Args:
        lab: L*, a* and b* [*shape, 3] under D65.

    Returns:
        Degrees [*shape]; larger is paler.

    Source:
        Chardon, Cretois & Hourseau 1991.
    """
    lightness, _, b = np.moveaxis(np.asarray(lab, np.float64), -1, 0)
    return np.asarray(np.rad2deg(np.arctan2(lightness - 50, b)))


def find_typology_group(angle: float) -> str:
    """Return the name of the group of a typology angle in degrees."""
    return next(name for name, low in TYPOLOGY_GROUPS.items() if angle > low or name == "dark")


def compute_melanin_index(spectra: ArrayLike) -> NDArray[np.float64]:
    """Compute the melanin index of a DermaSpectrometer, 100 log10(1 / R_red).

    Args:
        spectra: Reflectance [*shape, 33] at `BANDS`, above 0.

    Returns:
        Index [*shape]; larger is darker.

    Source:
        Takiwaki et al. 1994; Shriver & Parra 2000. The diodes are taken as narrow.
    """
    return np.asarray(-100 * np.log10(_interpolate(spectra, RED)))


def compute_erythema_index(spectra: ArrayLike) -> NDArray[np.float64]:
    """Compute the erythema index of a DermaSpectrometer, 100 log10(R_red / R_green).

    Args:
        spectra: Reflectance [*shape, 33] at `BANDS`, above 0.

    Returns:
        Index [*shape]; larger is redder.

    Source:
        Diffey, Oliver & Farr 1984; Shriver & Parra 2000. The diodes are taken as narrow.
    """
    red, green = _interpolate(spectra, RED), _interpolate(spectra, GREEN)
    return np.asarray(100 * np.log10(red / green))


def _interpolate(spectra: ArrayLike, wavelength: float) -> NDArray[np.float64]:
    """Interpolate linearly between the two bands about a wavelength."""
    values = np.asarray(spectra, np.float64)
    band = int(np.searchsorted(BANDS, wavelength)) - 1
    share = (wavelength - BANDS[band]) / (BANDS[band + 1] - BANDS[band])
    return np.asarray((1 - share) * values[..., band] + share * values[..., band + 1])
