"""A decomposition brought from the network's size to every pixel of the photograph."""

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.resizing import resize
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference.full_resolution._chromaticity import soft_mask
from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.inference.full_resolution._detail import pigment_detail

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Shares of linear sRGB in luminance (IEC 61966-2-1)."""

_BLOCK = 1 << 18
"""Pixels worked on at a time: few enough for the cache, many enough for NumPy."""

Image = NDArray[np.float32]


class Layers(NamedTuple):
    """Views of the photograph's size [H, W], or [H, W, 3], into which the maps are written."""

    melanin: Image
    hemoglobin: Image
    shading: Image
    specular: Image
    mask: Image
    offset: Image
    reconstruction: NDArray[np.uint8]

    def rows(self, block: slice) -> "Layers":
        """Views of some rows."""
        melanin, hemoglobin, shading, specular, mask, offset = (map_[block] for map_ in self[:6])
        pictures = offset, self.reconstruction[block]
        return Layers(melanin, hemoglobin, shading, specular, mask, *pictures)


def sharpen(
    layers: Layers,
    crop: NDArray[np.uint8],
    codes: Mapping[str, Image],
    table: ColourTable,
    shading_top: float,
    threads: int | None = None,
) -> None:
    """Write the detail of `crop`, uint8 sRGB [H, W, 3], into layers that hold the network's maps.

    Where there is skin, shading * skin + specular + offset is then the crop in linear sRGB:
    pigment from `pigment_detail`, gloss from the network but no brighter than the pixel, shading
    from the luminance of the rest, and the offset is what remains. The reconstruction has the
    network's offset instead, so it shows what skin explains. Layers keep the network's values
    where the mask has none.
    """
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        changes = pigment_detail(crop, codes, table, pool)
        height, width = crop.shape[:2]
        for layer, change, top in zip(layers[:2], changes, table.top, strict=True):
            layer += resize(change, width, height)
            np.clip(layer, 0, top, out=layer)
        rows = max(1, _BLOCK // width)
        blocks = [slice(start, start + rows) for start in range(0, height, rows)]
        # A list, so that an error in a block is raised.
        list(pool.map(lambda block: _explain(layers, crop, block, table, shading_top), blocks))


def _explain(
    layers: Layers, crop: NDArray[np.uint8], block: slice, table: ColourTable, shading_top: float
) -> None:
    some = layers.rows(block)
    weight = soft_mask(some.mask)
    at = np.nonzero(weight)
    if not at[0].size:
        return
    share = weight[at]
    linear = srgb_to_linear(crop[block][at])
    skin = table(some.melanin[at], some.hemoglobin[at])
    known, gloss = some.offset[at], some.specular[at]
    gloss -= share * np.maximum(gloss - linear.min(-1), 0)
    light = linear - gloss[:, None]
    shading = _shading(light - known, skin, shading_top)
    shading = _between(some.shading[at], shading, share)
    skin *= shading[:, None]
    some.shading[at] = shading
    some.specular[at] = gloss
    some.offset[at] = _between(known, light - skin, share[:, None])
    made = linear_to_srgb(skin + gloss[:, None] + known) * 255
    soft = some.reconstruction[at].astype(np.float32)
    some.reconstruction[at] = to_uint8(_between(soft, made, share[:, None]) / 255)


def _shading(light: Image, skin: Image, top: float) -> Image:
    """Luminance of light [pixels, 3] relative to that of skin [pixels, 3]."""
    shading: Image = (_luminance(light) / np.maximum(_luminance(skin), 1e-4)).clip(0, top)
    return shading


def _luminance(linear: Image) -> Image:
    # Not a matrix product, whose rounding depends on the number of pixels.
    red, green, blue = linear.T
    luminance: Image = LUMINANCE[0] * red + LUMINANCE[1] * green + LUMINANCE[2] * blue
    return luminance


def _between(a: Image, b: Image, share: Image) -> Image:
    return a + share * (b - a)
