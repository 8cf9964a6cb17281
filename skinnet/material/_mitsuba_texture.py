"""The texture plug-in `skin` for Mitsuba 3: a skin's spectrum from two pigment maps."""

from functools import cache
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
import torch
from jaxtyping import Float32

from skinnet.material._offset_spectra import compute_offset_spectra
from skinnet.physics._pigment_axis import PigmentAxis
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb
from skinnet.physics.spectra import WAVELENGTHS

PLUGIN = "skin"
"""Name of the plug-in in scenes."""

_NODES = (128, 64)
"""Nodes of the table in f_mel and f_blood."""

_SPACING = (0.02, 0.02)
"""Spacing of the nodes in f_mel and f_blood: finer where a fraction is small."""

_AXES = tuple(
    PigmentAxis(0.0, 1.0, nodes, spacing) for nodes, spacing in zip(_NODES, _SPACING, strict=True)
)
_LOGARITHMS = tuple(
    (scale / axis.nodes, (shift + 0.5) / axis.nodes)
    for axis in _AXES
    for scale, shift in [axis.scale_and_shift]
)
"""Scale and shift from log(f + spacing) to a coordinate of the table."""

_FIRST, _LAST = float(WAVELENGTHS[0]), float(WAVELENGTHS[-1])
_STEP = float(WAVELENGTHS[1] - WAVELENGTHS[0])
_BAND_SCALE = 1 / (_STEP * len(WAVELENGTHS))
_BAND_SHIFT = (0.5 - _FIRST / _STEP) / len(WAVELENGTHS)
"""Scale and shift from a wavelength to a coordinate of the table."""


@cache
def register(variant: str) -> None:
    """Register the plug-in for a variant of Mitsuba; the variant must be the one that is set.

    Args:
        variant: The variant, e.g. scalar_spectral.
    """
    mi.register_texture(PLUGIN, _make_class())


def _make_class() -> type:
    """Make the plug-in's class; its base is that of the variant that is set."""

    class SkinTexture(mi.Texture):
        """Reflectance of skin; see `MitsubaCapture.skin` for its parameters."""

        def __init__(self, props: Any) -> None:
            super().__init__(props)
            self.melanin = props.get_unbounded_texture("melanin")
            self.hemoglobin = props.get_unbounded_texture("hemoglobin")
            self.optics = str(props.get("optics", "measured"))
            self.table = _make_table(self.optics)
            self.offset = props.get_unbounded_texture("offset", 0.0) if "offset" in props else None
            spectra = str(props.get("offset_spectra", ""))
            self.spectra: Any = None if self.offset is None else _make_spectra(spectra)

        def eval(self, si: Any, active: Any = True) -> Any:
            blood = _find_place(self.hemoglobin.eval_1(si, active), 1)
            melanin = _find_place(self.melanin.eval_1(si, active), 0)
            bands = si.wavelengths * _BAND_SCALE + _BAND_SHIFT
            values = [
                self.table.eval(mi.Point3f(band, blood, melanin), active)[0] for band in bands
            ]
            if self.offset is not None:
                offset = self.offset.eval_3(si, active)
                values = [
                    dr.clip(value + self._add_offset(offset, band, active), 0, 1)
                    for value, band in zip(values, bands, strict=True)
                ]
            return mi.UnpolarizedSpectrum(values)

        def _add_offset(self, offset: Any, band: Any, active: Any) -> Any:
            red, green, blue = self.spectra.eval(mi.Point1f(band), active)
            return offset[0] * red + offset[1] * green + offset[2] * blue

        def mean(self) -> Any:
            middle = mi.Point3f(
                0.5, _find_place(self.hemoglobin.mean(), 1), _find_place(self.melanin.mean(), 0)
            )
            return self.table.eval(middle)[0]

        def max(self) -> float:
            return 1.0

        def resolution(self) -> Any:
            return self.melanin.resolution()

        def spectral_resolution(self) -> float:
            return _STEP

        def wavelength_range(self) -> Any:
            return mi.ScalarVector2f(_FIRST, _LAST)

        def is_spatially_varying(self) -> bool:
            return True

        def traverse(self, callback: Any) -> None:
            callback.put("melanin", self.melanin, mi.ParamFlags.Differentiable)
            callback.put("hemoglobin", self.hemoglobin, mi.ParamFlags.Differentiable)
            if self.offset is not None:
                callback.put("offset", self.offset, mi.ParamFlags.Differentiable)

        def to_string(self) -> str:
            return f"Skin[optics={self.optics}, melanin={self.melanin}, blood={self.hemoglobin}]"

    return SkinTexture


def _find_place(fraction: Any, axis: int) -> Any:
    """Coordinate of a volume fraction in the table, in [0, 1]; ends are held."""
    scale, shift = _LOGARITHMS[axis]
    return scale * dr.log(dr.maximum(fraction, 0) + _SPACING[axis]) + shift


def _make_table(optics: str) -> Any:
    """Table of reflectance over f_mel, f_blood and wavelength, read by linear interpolation."""
    kind: Any = mi.Texture3f
    return kind(mi.TensorXf(_compute_table(optics)), wrap_mode=dr.WrapMode.Clamp)


@cache
def _compute_table(optics: str) -> Float32[np.ndarray, "mel blood wavelength 1"]:
    reflectance = SkinReflectance(optics, dtype=torch.float64)
    f_mel, f_blood = (
        torch.from_numpy(axis.fractions(np.arange(float(axis.nodes)))) for axis in _AXES
    )
    with torch.no_grad():
        table = reflectance(f_mel[:, None], f_blood[None])
    return np.asarray(table.numpy()[..., None], np.float32)


def _make_spectra(text: str) -> Any:
    """Spectra of red, green and blue of an offset; without them those of D65 and a mean camera."""
    if text:
        spectra = np.array(text.split(","), np.float32).reshape(3, len(WAVELENGTHS))
    else:
        spectra = compute_offset_spectra(load_spectrum_to_srgb("D65", "mean").numpy())
    rows = np.ascontiguousarray(spectra.T, np.float32)
    kind: Any = mi.Texture1f
    return kind(mi.TensorXf(rows), wrap_mode=dr.WrapMode.Clamp)
