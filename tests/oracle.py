"""Skin and camera a second time, in NumPy, written independently of the package.

Nothing here imports `skinnet`, so a mistake would have to be made twice, in two ways, to go
unnoticed. Only the tables of measured numbers are shared.
"""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

TABLES = Path(__file__).parents[1] / "skinnet" / "physics" / "tables"
WAVELENGTHS = np.arange(400.0, 721.0, 10.0)
D65 = np.array([0.3127 / 0.3290, 1.0, (1 - 0.3127 - 0.3290) / 0.3290])

PAPER: Mapping[str, float] = MappingProxyType(
    {
        "c_eum": 80.0,
        "c_phm": 12.0,
        "f_eum": 0.61,
        "c_hem": 150.0,
        "g": 64500.0,
        "f_oxy": 0.75,
        "d_epd": 0.021,
        "d_pd": 0.2,
        "r": 0.0,
        "floor": 0.244,
        "scale": 85.3,
        "mie": 2e5,
        "rayleigh": 2e12,
    }
)

MEASURED: Mapping[str, float] = MappingProxyType(
    {
        "f_oxy": 0.687,
        "d_epd": 0.014,
        "d_pd": 0.219,
        "r": 5.86e-4,
        "r_melanin": 5.35e-4,
        "floor": 0.188,
        "scale": 65.9,
        "mie": 2.46e5,
        "rayleigh": 2.27e12,
    }
)


def columns(name: str) -> dict[str, Array]:
    """Read a table of one row a wavelength."""
    with (TABLES / f"{name}.csv").open(encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    values = np.array(rows[1:], dtype=float)
    assert np.array_equal(values[:, 0], WAVELENGTHS)
    return dict(zip(rows[0][1:], values[:, 1:].T, strict=True))


def measured_cameras() -> dict[str, Array]:
    """Read the sensitivities of each measured camera, [33, 3]."""
    with (TABLES / "cameras.csv").open(encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    curves = {(row[0], row[1]): np.array(row[2:], dtype=float) for row in rows}
    names = dict.fromkeys(name for name, _ in curves)
    return {name: np.stack([curves[name, c] for c in "RGB"], axis=-1) for name in names}


def pack_pigment(mu: Array, r: float) -> Array:
    """Pigment packaging: the absorption of blood in vessels of radius r (Duysens 1956)."""
    return mu if r == 0 else mu * -np.expm1(-2 * mu * r) / (2 * mu * r)


def baseline(floor: float = 0.244, scale: float = 85.3) -> Array:
    """Return the absorption of tissue without pigment."""
    return floor + scale * np.exp(-(WAVELENGTHS - 154) / 66.2)


def scattering(mie: float = 2e5, rayleigh: float = 2e12) -> Array:
    """Return the reduced scattering of the dermis, Mie and Rayleigh."""
    return mie * WAVELENGTHS**-1.5 + rayleigh * WAVELENGTHS**-4


def kubelka_munk(k: Array, s: Array, d: float, printed: bool = False) -> Array:
    """Reflectance of a layer over black, in the exponential form of section 3.3.

    The paper prints 1 + beta^2 and 1 - beta^2 for (1 + beta)^2 and (1 - beta)^2.
    """
    K, beta = np.sqrt(k * (k + 2 * s)), np.sqrt(k / (k + 2 * s))
    plus, minus = (1 + beta**2, 1 - beta**2) if printed else ((1 + beta) ** 2, (1 - beta) ** 2)
    decay = np.exp(-2 * K * d)
    return (1 - beta**2) * (1 - decay) / (plus - minus * decay)


def reflectance(preset: str, f_mel: ArrayLike, f_blood: ArrayLike, **constants: float) -> Array:
    """Return the spectra, [..., 33], of a preset with some of its constants changed."""
    mel, blood = (np.asarray(f, dtype=float)[..., None] for f in (f_mel, f_blood))
    own = {
        "printed": {},
        "authors": {"g": 66500.0, "d_epd": 0.02, "d_pd": 0.3},
        "paper": {},
        "calibrated": {"r": 20e-4},
        "measured": MEASURED,
    }[preset]
    c = {**PAPER, **own, **constants}
    base = baseline(0.0244, 8.53) if preset == "authors" else baseline(c["floor"], c["scale"])
    absorbed = _epidermis(preset, mel, blood, base, c)
    k = blood * _blood(c) + (1 - blood) * base
    s = scattering(c["mie"], c["rayleigh"])
    return np.exp(-2 * absorbed) * kubelka_munk(k, s, c["d_pd"], preset == "printed")


def reflectance_of_one(f_mel: float, f_blood: float, nuisance: Sequence[float]) -> Array:
    """Return the spectrum, [33], of one skin of `measured` whose constants deviate.

    In this order: ln thickness and ln scattering of the dermis, share of oxygenated hemoglobin,
    ln baseline absorption.
    """
    thickness, scattering, oxygenation, base = nuisance
    d_pd = MEASURED["d_pd"] * np.e**thickness
    s = {name: MEASURED[name] * np.e**scattering for name in ("mie", "rayleigh")}
    floor, scale = (MEASURED[name] * np.e**base for name in ("floor", "scale"))
    f_oxy = min(max(MEASURED["f_oxy"] + oxygenation, 0.0), 1.0)
    return reflectance(
        "measured", f_mel, f_blood, d_pd=d_pd, floor=floor, scale=scale, f_oxy=f_oxy, **s
    )


def _epidermis(preset: str, mel: Array, blood: Array, base: Array, c: Mapping[str, float]) -> Array:
    if preset == "printed":
        return mel * _melanin(6.6e11, -3.33, 2.9e10, -4.75, c) * c["d_epd"] + (1 - mel) * base
    if preset == "measured":
        mu_mel = pack_pigment(6.6e11 * WAVELENGTHS**-3.33, c["r_melanin"])
        return c["d_epd"] * (mel * mu_mel + (1 - mel) * base)
    tables = columns("melanin")
    mu_mel = c["f_eum"] * tables["eumelanin"] * c["c_eum"]
    mu_mel = mu_mel + (1 - c["f_eum"]) * tables["pheomelanin"] * c["c_phm"]
    if preset != "authors":
        return c["d_epd"] * (mel * mu_mel + (1 - mel) * base)
    oxy, deoxy = _hemoglobin(c)
    f = c["f_oxy"]
    share = 0.25 * blood
    hemoglobin = share * (f * (f * oxy) + (1 - f) * ((1 - f) * deoxy))
    return mel * mu_mel * c["d_epd"] + hemoglobin + (1 - mel - share) * base


def _melanin(a: float, p: float, b: float, q: float, c: Mapping[str, float]) -> Array:
    eum, phm = a * WAVELENGTHS**p * c["c_eum"], b * WAVELENGTHS**q * c["c_phm"]
    return c["f_eum"] * eum + (1 - c["f_eum"]) * phm


def _hemoglobin(c: Mapping[str, float]) -> tuple[Array, Array]:
    tables = columns("hemoglobin")
    oxy, deoxy = (2.303 * c["c_hem"] / c["g"] * tables[name] for name in ("oxy", "deoxy"))
    return oxy, deoxy


def _blood(c: Mapping[str, float]) -> Array:
    oxy, deoxy = _hemoglobin(c)
    return pack_pigment(c["f_oxy"] * oxy + (1 - c["f_oxy"]) * deoxy, c["r"])


def srgb_to_xyz() -> Array:
    """Derive the matrix of IEC 61966-2-1 from its primaries and its white."""
    x, y = np.array([0.64, 0.30, 0.15]), np.array([0.33, 0.60, 0.06])
    primaries = np.stack([x / y, np.ones(3), (1 - x - y) / y])
    return primaries * np.linalg.solve(primaries, D65)


def camera_to_xyz(sensitivity: Array) -> Array:
    """Fit the observer with the camera's balanced curves, then sends white to D65."""
    solution, *_ = np.linalg.lstsq(sensitivity, np.stack(_observer(), axis=-1), rcond=None)
    matrix = solution.T
    return matrix * (D65 / matrix.sum(axis=1))[:, None]


def linear_srgb(spectra: Array, light: Array, sensitivity: Array) -> Array:
    """Photograph reflectance spectra, [..., 33], in linear sRGB, [..., 3]."""
    light = light / light.sum()
    sensitivity = sensitivity / np.einsum("j,jc->c", light, sensitivity)
    balanced = np.einsum("...j,j,jc->...c", spectra, light, sensitivity)
    return balanced @ camera_to_xyz(sensitivity).T @ np.linalg.inv(srgb_to_xyz()).T


def _observer() -> list[Array]:
    curves = columns("observer")
    return [curves[name] for name in ("x_bar", "y_bar", "z_bar")]


def daylight(temperature: float) -> Array:
    """Return the CIE daylight of a correlated colour temperature in kelvin, unit sum."""
    t = 1e3 / temperature
    if temperature <= 7000:
        x = 0.244063 + 0.09911 * t + 2.9678 * t**2 - 4.6070 * t**3
    else:
        x = 0.237040 + 0.24748 * t + 1.9018 * t**2 - 2.0064 * t**3
    y = -3 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / m
    m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / m
    s = columns("daylight")
    power = s["s0"] + m1 * s["s1"] + m2 * s["s2"]
    return power / power.sum()
