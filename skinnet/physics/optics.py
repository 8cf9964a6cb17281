"""The skin's optical constants, each with its unit, range and source, and the five presets."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._tables import read_table
from skinnet.physics.dermis import _kubelka_munk_printed, kubelka_munk
from skinnet.physics.spectra import WAVELENGTHS

Constant = float | int | Tensor


def _constant(value: Any, unit: str, low: float, high: float, source: str) -> Any:
    note = {"unit": unit, "range": (low, high), "source": source}
    return field(default=value, metadata=note)


def _spectrum(values: Callable[[], Tensor], unit: str, source: str) -> Any:
    note = {"unit": unit, "range": (0.0, 1e7), "source": source}
    return field(default_factory=values, metadata=note)


def _read_column(table: str, column: str) -> Float[Tensor, "wavelength"]:
    return read_table(table)[column]


def _power_law(scale: float, power: float) -> Float[Tensor, "wavelength"]:
    return scale * WAVELENGTHS**power


_FITTED = "fitted to measured spectra, starting from the literature: "


@dataclass(frozen=True, eq=False)
class SkinOptics:
    """Constants of the two-layer skin model; the defaults are the `measured` preset.

    Each constant is a float, a tensor, or an `nn.Parameter`, which makes it trainable in whatever
    module is built on it. The metadata of its field holds `unit`, `range` and `source`.

    Args:
        c_eum: Eumelanin concentration, g/L (Table 1).
        c_phm: Pheomelanin concentration, g/L (Table 1).
        f_eum: Share of eumelanin in melanin, in [0, 1] (Table 1).
        c_hem: Hemoglobin concentration of blood, g/L (Table 1).
        g: Molar mass of hemoglobin, g/mol (Table 1).
        f_oxy: Share of oxygenated hemoglobin, in [0, 1] (Table 1).
        d_epd: Thickness of the epidermis, cm (Table 1).
        d_pd: Thickness of the papillary dermis, cm (Table 1).
        d_base: Path of the epidermis' baseline absorption, cm; None: `d_epd`. The printed equation
            has no such factor, which is the same as 1.
        r_vessel: Radius of blood vessels, cm; 0: no pigment packaging, as in the paper.
        r_melanin: Radius of the packets that melanosomes form, cm; 0: no pigment packaging, as in
            the paper.
        blood_epd: Blood in the epidermis, as a fraction of f_blood; not in the paper.
        base_floor: Constant of the baseline absorption, cm^-1 (Table 2).
        base_scale: Factor of the baseline absorption's exponential, cm^-1 (Table 2).
        mie: Factor of Mie scattering, cm^-1 nm^1.5 (Table 2).
        rayleigh: Factor of Rayleigh scattering, cm^-1 nm^4 (Table 2).
        eps_eum: Extinction of eumelanin [33], L g^-1 cm^-1. Table 2 prints the absorption of a
            melanosome's interior in its place, which makes every skin black.
        eps_phm: Extinction of pheomelanin [33], L g^-1 cm^-1. Measured, instead of Table 2.
        e_oxy: Molar extinction of oxyhemoglobin [33], cm^-1/(mol/L) (Table 3).
        e_deoxy: Molar extinction of deoxyhemoglobin [33], cm^-1/(mol/L) (Table 3).
        dermis: Reflectance of a layer of absorption k, scattering s and thickness d (section 3.3).

    Raises:
        InputError: For a value outside its range; it is a `ValueError`.

    Source:
        Tables 1 to 3 of Alotaibi & Smith 2017; `python -m tools.fit_skin` for what was fitted to
        measured spectra.

    Example:
        >>> from dataclasses import fields
        >>> from skinnet.physics import SkinOptics
        >>> SkinOptics.preset("paper", d_pd=0.1).d_pd
        0.1
        >>> next(item.metadata["unit"] for item in fields(SkinOptics) if item.name == "d_pd")
        'cm'
    """

    c_eum: Constant = _constant(80.0, "g/L", 0.0, 1e3, "Thody et al. 1991")
    c_phm: Constant = _constant(12.0, "g/L", 0.0, 1e3, "Thody et al. 1991")
    f_eum: Constant = _constant(
        1.0, "fraction", 0.0, 1.0, "1: eps_eum is that of melanin as a whole; Jacques 1998"
    )
    c_hem: Constant = _constant(150.0, "g/L", 0.0, 1e3, "Flewelling 1981")
    g: Constant = _constant(64500.0, "g/mol", 1e4, 1e5, "Jacques 1998")
    f_oxy: Constant = _constant(0.687, "fraction", 0.0, 1.0, _FITTED + "Mitsou et al. 2014 has .75")
    d_epd: Constant = _constant(
        0.014, "cm", 0.0, 1.0, "convention: 70 um that diffuse light crosses at twice their length"
    )
    d_pd: Constant = _constant(0.219, "cm", 1e-6, 10.0, _FITTED + "Anderson & Parrish 1981 have .2")
    d_base: Constant | None = _constant(
        None, "cm", 0.0, 1.0, "path of the epidermis' baseline absorption; None: d_epd"
    )
    r_vessel: Constant = _constant(
        5.86e-4, "cm", 0.0, 0.1, _FITTED + "pigment packaging, Duysens 1956; 0: off"
    )
    r_melanin: Constant = _constant(
        5.35e-4, "cm", 0.0, 0.1, _FITTED + "pigment packaging, Duysens 1956; 0: off"
    )
    blood_epd: Constant = _constant(
        0.0, "fraction of f_blood", 0.0, 1.0, "blood in the epidermis; only the authors' release"
    )
    base_floor: Constant = _constant(0.188, "cm^-1", 0.0, 1e3, _FITTED + "Jacques 1998 has .244")
    base_scale: Constant = _constant(65.9, "cm^-1", 0.0, 1e5, _FITTED + "Jacques 1998 has 85.3")
    mie: Constant = _constant(2.46e5, "cm^-1 nm^1.5", 0.0, 1e9, _FITTED + "Jacques 1996 has 2e5")
    rayleigh: Constant = _constant(
        2.27e12, "cm^-1 nm^4", 0.0, 1e16, _FITTED + "Jacques 1996 has 2e12"
    )
    eps_eum: Tensor = _spectrum(
        lambda: _power_law(6.6e11 / 80, -3.33), "L g^-1 cm^-1", "Jacques 1998, over c_eum"
    )
    eps_phm: Tensor = _spectrum(
        partial(_read_column, "melanin", "pheomelanin"), "L g^-1 cm^-1", "OMLC, Sarna & Swartz"
    )
    e_oxy: Tensor = _spectrum(
        partial(_read_column, "hemoglobin", "oxy"), "cm^-1/(mol/L)", "Prahl 1999"
    )
    e_deoxy: Tensor = _spectrum(
        partial(_read_column, "hemoglobin", "deoxy"), "cm^-1/(mol/L)", "Prahl 1999"
    )
    dermis: Callable[[Tensor, Tensor, Tensor], Tensor] = kubelka_munk

    def __post_init__(self) -> None:
        for item in fields(self):
            if "range" in item.metadata and (value := getattr(self, item.name)) is not None:
                _check_range(item.name, _as_tensor(item.name, value), **item.metadata)
        for name in _SPECTRA:
            if (shape := tuple(getattr(self, name).shape)) != tuple(WAVELENGTHS.shape):
                raise InputError(f"{name} has one value for each of 33 bands; got shape {shape}.")

    @staticmethod
    def preset(name: str, **constants: Any) -> "SkinOptics":
        """Return one of `PRESETS`, with some constants replaced.

        Args:
            name: `measured`, `calibrated`, `paper`, `authors` or `printed`.
            constants: New values of constants, by name.

        Returns:
            The constants.

        Raises:
            InputError: For an unknown preset or constant, or a value out of its range.
        """
        if name not in PRESETS:
            raise InputError(f"There is no preset {name!r}; the presets are {', '.join(PRESETS)}.")
        known = {item.name for item in fields(SkinOptics)}
        if unknown := set(constants) - known:
            raise InputError(
                f"SkinOptics has no constant {', '.join(sorted(unknown))}; "
                f"it has {', '.join(sorted(known))}."
            )
        return replace(PRESETS[name], **constants)


_SPECTRA = ("eps_eum", "eps_phm", "e_oxy", "e_deoxy")


def _as_tensor(name: str, value: object) -> Tensor:
    if isinstance(value, Tensor | float | int):
        return torch.as_tensor(value).detach()
    raise InputError(f"{name} is a number or a tensor; got {value!r}.")


def _check_range(
    name: str, value: Tensor, unit: str, range: tuple[float, float], source: str
) -> None:
    low, high = range
    outside = value[~((value >= low) & (value <= high))]
    if outside.numel():
        raise InputError(
            f"{name} is in {unit} and lies in [{low:g}, {high:g}]; got {outside.flatten()[0]:g}. "
            f"Source of its default: {source}."
        )


_TABLES_1_TO_3 = SkinOptics(
    f_eum=0.61,
    f_oxy=0.75,
    d_epd=0.021,
    d_pd=0.2,
    r_vessel=0.0,
    r_melanin=0.0,
    base_floor=0.244,
    base_scale=85.3,
    mie=2e5,
    rayleigh=2e12,
    eps_eum=_read_column("melanin", "eumelanin"),
)

PRESETS: Mapping[str, SkinOptics] = MappingProxyType(
    {
        "measured": SkinOptics(),
        "calibrated": replace(_TABLES_1_TO_3, r_vessel=20e-4),
        "paper": _TABLES_1_TO_3,
        "authors": replace(
            _TABLES_1_TO_3,
            d_epd=0.02,
            d_pd=0.3,
            g=66500.0,
            base_floor=0.0244,
            base_scale=8.53,
            d_base=1.0,
            blood_epd=0.25,
        ),
        "printed": replace(
            _TABLES_1_TO_3,
            eps_eum=_power_law(6.6e11, -3.33),
            eps_phm=_power_law(2.9e10, -4.75),
            d_base=1.0,
            dermis=_kubelka_munk_printed,
        ),
    }
)
"""Constants by name: Tables 1 to 3 of Alotaibi & Smith 2017, and what measured spectra change.

- `measured` (default): fitted to the spectra of faces and forearms of all tones, with the
  literature as the starting point. `python -m tools.fit_skin` prints how far each constant moved.
- `calibrated`: `paper` with blood in vessels of 20 um radius, chosen on 100 forearms.
- `paper`: Tables 1 to 3 in consistent units.
- `authors`: the constants of the authors' later MATLAB release (github.com/ssma502/SkinModel).
- `printed`: the paper's text, literally. It makes every skin black and is kept for comparison.
"""
