"""RGB spaces with a name, and the code points of ITU-T H.273 for primaries and transfer."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images._icc import SRGB_PRIMARIES, Primaries, make_profile, sample_curve

_Decode = Callable[[NDArray[Any]], NDArray[Any]]

_D65, _C, _D50 = (0.3127, 0.3290), (0.310, 0.316), (0.34567, 0.35850)
_ADOBE = Primaries(_D65, (0.64, 0.33), (0.21, 0.71), (0.15, 0.06))
_P3 = Primaries(_D65, (0.68, 0.32), (0.265, 0.69), (0.15, 0.06))
_BT2020 = Primaries(_D65, (0.708, 0.292), (0.17, 0.797), (0.131, 0.046))

CODED_PRIMARIES = {
    1: SRGB_PRIMARIES,
    4: Primaries(_C, (0.67, 0.33), (0.21, 0.71), (0.14, 0.08)),
    5: Primaries(_D65, (0.64, 0.33), (0.29, 0.60), (0.15, 0.06)),
    6: Primaries(_D65, (0.63, 0.34), (0.31, 0.595), (0.155, 0.07)),
    7: Primaries(_D65, (0.63, 0.34), (0.31, 0.595), (0.155, 0.07)),
    8: Primaries(_C, (0.681, 0.319), (0.243, 0.692), (0.145, 0.049)),
    9: _BT2020,
    11: Primaries((0.314, 0.351), (0.68, 0.32), (0.265, 0.69), (0.15, 0.06)),
    12: _P3,
    22: Primaries(_D65, (0.63, 0.34), (0.295, 0.605), (0.155, 0.077)),
}
"""Primaries by their code in cICP and nclx; 10 is XYZ, and 2 is not specified."""

HDR_TRANSFERS = {16: "PQ", 18: "HLG"}
"""Codes of transfers whose white is not the brightest pixel."""


class NamedSpace(NamedTuple):
    """An RGB space: its name, primaries, and the exponent or curve from pixels to light."""

    name: str
    primaries: Primaries
    curve: float | _Decode

    def profile(self) -> bytes | None:
        """The profile of the space; None for sRGB."""
        if self.primaries == SRGB_PRIMARIES and self.curve is decode_srgb:
            return None
        return _make_profile(self.primaries, self.curve)


def decode_srgb(pixels: NDArray[Any]) -> NDArray[Any]:
    """Linear light of pixels in [0, 1] (IEC 61966-2-1)."""
    return np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4)


def decode_bt709(pixels: NDArray[Any]) -> NDArray[Any]:
    """Linear light of pixels in [0, 1] (ITU-R BT.709, and BT.2020 with the same constants)."""
    return np.where(pixels < 0.081, pixels / 4.5, ((pixels + 0.099) / 1.099) ** (1 / 0.45))


CODED_TRANSFERS: dict[int, float | _Decode] = {
    **dict.fromkeys((1, 6, 14, 15), decode_bt709),
    4: 2.2,
    5: 2.8,
    8: 1.0,
    13: decode_srgb,
}
"""Exponent or curve by its code in cICP and nclx; 2 is not specified."""

SRGB = NamedSpace("sRGB", SRGB_PRIMARIES, decode_srgb)
ADOBE_RGB = NamedSpace("Adobe RGB (1998)", _ADOBE, 563 / 256)
DISPLAY_P3 = NamedSpace("Display P3", _P3, decode_srgb)
WIDE_GAMUT_RGB = NamedSpace(
    "Adobe Wide Gamut RGB",
    Primaries(_D50, (0.7347, 0.2653), (0.1152, 0.8264), (0.1566, 0.0177)),
    563 / 256,
)
_NAMED = (SRGB, ADOBE_RGB, DISPLAY_P3)
_TOLERANCE = 0.004
"""Largest difference of chromaticities that files round to, and of exponents relative to 1."""


def find_space(primaries: Primaries, exponent: float | None) -> NamedSpace:
    """The space of stated primaries and exponent.

    Files state sRGB's curve as the exponent 2.2, since they have no word for it; so do those of
    Display P3. With these primaries, 2.2 means that curve.
    """
    for space in _NAMED:
        near = np.allclose(primaries, space.primaries, atol=_TOLERANCE)
        if near and (exponent is None or abs(exponent / 2.2 - 1) < 0.02):
            return space
    name = "RGB" if not np.allclose(primaries, SRGB_PRIMARIES, atol=_TOLERANCE) else "sRGB"
    if exponent is None:
        return NamedSpace(f"{name} with primaries of its own", primaries, decode_srgb)
    return NamedSpace(_describe(primaries, exponent), primaries, float(exponent))


def find_coded_space(primaries: int, transfer: int) -> NamedSpace | None:
    """The space of two code points; 2, not specified, is that of sRGB. None for unknown codes."""
    chosen = SRGB_PRIMARIES if primaries == 2 else CODED_PRIMARIES.get(primaries)
    curve = decode_srgb if transfer == 2 else CODED_TRANSFERS.get(transfer)
    if chosen is None or curve is None:
        return None
    for space in _NAMED:
        if space.primaries == chosen and space.curve is curve:
            return space
    return NamedSpace(f"H.273 primaries {primaries}, transfer {transfer}", chosen, curve)


def _describe(primaries: Primaries, exponent: float) -> str:
    named = next(
        (each.name for each in _NAMED if np.allclose(primaries, each.primaries, atol=_TOLERANCE)),
        "stated",
    )
    linear = abs(exponent - 1) < 1e-3
    return f"{named} primaries, {'linear' if linear else f'exponent {exponent:.4g}'}"


@cache
def _make_profile(primaries: Primaries, curve: float | _Decode) -> bytes:
    if callable(curve):
        return make_profile(primaries, sample_curve(curve))
    return make_profile(primaries, curve)
