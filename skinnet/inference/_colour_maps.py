"""Maps in colour at the photograph's size, on the scales of the panel."""

from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._mark import Mark
from skinnet.images._png_file import write_palette_png
from skinnet.inference._colour_scales import PIGMENTS, SHADING, SPECULAR, Scale
from skinnet.inference._tiles import BLANK
from skinnet.inference.decomposition import SKIN_THRESHOLD, Decomposition

ColourMaps = Literal["pigments", "all", "none"]
"""Which maps are written in colour too."""

_SCALES = {**PIGMENTS, "shading": SHADING, "specular": SPECULAR}
_NAMES: dict[str, tuple[str, ...]] = {
    "pigments": tuple(PIGMENTS),
    "all": tuple(_SCALES),
    "none": (),
}

_STRIP = 256
"""Rows that are coloured at once, which bounds the memory."""


def list_colour_maps(which: str) -> tuple[str, ...]:
    """List the maps that are written in colour; their files are NAME_MAP_colour.png.

    Raises:
        InputError: There is no such choice.
    """
    if which not in _NAMES:
        raise InputError(f"colour_maps is {', '.join(_NAMES)}; got {which!r}.")
    return _NAMES[which]


def describe_colour_maps(which: ColourMaps) -> dict[str, Any]:
    """Describe the scales of the maps in colour, for JSON."""
    return {name: _describe_scale(_SCALES[name]) for name in _NAMES[which]}


def write_colour_map(path: Path, name: str, decomposition: Decomposition, digest: str) -> None:
    """Write a map in colour: a PNG file of 256 colours, the first for what is not skin.

    Args:
        path: The file.
        name: The map: melanin, hemoglobin, shading or specular.
        decomposition: The decomposition.
        digest: SHA-256 of the photograph's file, for the mark.
    """
    scale = _SCALES[name]
    palette = np.concatenate([[BLANK], scale.ramp(np.linspace(0, 1, 255))]).astype(np.uint8)
    text = {
        "Description": f"{name} in colour; grey is outside of the mask",
        "colour_scale": _describe_in_words(scale),
    }
    pixels = _find_colours(decomposition.get_map(name), decomposition.mask, scale)
    write_palette_png(path, pixels, palette, text | Mark("predict", "colour", digest).to_text())


def _find_colours(
    values: NDArray[np.float32], mask: NDArray[np.float32], scale: Scale
) -> NDArray[np.uint8]:
    """Numbers of the colours [H, W] in the palette."""
    pixels = np.zeros(values.shape, np.uint8)
    for top in range(0, len(values), _STRIP):
        rows = slice(top, top + _STRIP)
        places = 1 + np.rint(254 * scale.place(values[rows]).clip(0, 1))
        pixels[rows] = np.where(mask[rows] > SKIN_THRESHOLD, places, 0)
    return pixels


def _describe_scale(scale: Scale) -> dict[str, Any]:
    return {
        "measure": scale.measure,
        "unit": scale.symbol,
        "ticks": list(scale.ticks),
        "linear_to": scale.ticks[-1] if scale.knee is None else scale.knee,
        "colours": ["#{:02x}{:02x}{:02x}".format(*colour) for colour in scale.colours],
        "outside_mask": "#{:02x}{:02x}{:02x}".format(*BLANK),
    }


def _describe_in_words(scale: Scale) -> str:
    top = f"{scale.ticks[-1]:g} {scale.symbol}"
    shape = "linear"
    if scale.knee is not None:
        shape = f"linear up to {scale.knee:g} {scale.symbol}, then logarithmic"
    colours = " ".join(_describe_scale(scale)["colours"])
    return f"{scale.measure}: 0 to {top}, {shape}; evenly spaced colours {colours}"
