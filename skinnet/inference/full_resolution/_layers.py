"""The maps of a crop at its full size, with the detail of the photograph."""

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.images.resizing import resize
from skinnet.images.srgb import LUMINANCE_WEIGHTS, linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.inference._editing import soften_mask
from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.inference.full_resolution._detail import recover_detail

_BLOCK = 1 << 18
"""Pixels of a block: few enough for the cache, many enough for NumPy."""

Image = NDArray[np.float32]


class Layers(NamedTuple):
    """Maps of a crop, float32 [H, W] or [H, W, 3], and its reconstruction, uint8 sRGB."""

    melanin: Image
    hemoglobin: Image
    shading: Image
    specular: Image
    mask: Image
    offset: Image
    reconstruction: NDArray[np.uint8]

    def view_rows(self, rows: slice) -> "Layers":
        """Views of some rows."""
        melanin, hemoglobin, shading, specular, mask, offset = (map_[rows] for map_ in self[:6])
        pictures = offset, self.reconstruction[rows]
        return Layers(melanin, hemoglobin, shading, specular, mask, *pictures)


def enlarge_layers(maps: Mapping[str, Image], decoded: Image, width: int, height: int) -> Layers:
    """Enlarge the network's maps [h, w] and the decoder's sRGB [h, w, 3] to the crop's size."""
    offset = np.empty((height, width, 3), np.float32)
    for channel in range(3):
        offset[..., channel] = resize(maps["offset"][..., channel], width, height)
    return Layers(
        melanin=resize(maps["melanin"], width, height),
        hemoglobin=resize(maps["hemoglobin"], width, height),
        shading=resize(maps["shading"], width, height),
        specular=resize(maps["specular"], width, height),
        mask=resize(maps["mask"], width, height),
        offset=offset,
        reconstruction=resize(to_uint8(decoded), width, height),
    )


def sharpen_layers(
    crop: NDArray[np.uint8],
    maps: Mapping[str, Image],
    decoded: Image,
    table: ColourTable,
    shading_top: float,
    threads: int | None = None,
) -> Layers:
    """Enlarge the network's maps, and add the detail of the crop where there is skin.

    There, shading * skin + specular + offset equals the crop in linear sRGB: pigments have the
    detail of `recover_detail`, specular is the network's but no brighter than the pixel, shading is
    the ratio of luminances, and offset is the rest. The reconstruction has the network's offset
    instead, so it shows what the skin model explains. Off skin all layers are the network's.

    Args:
        crop: uint8 sRGB [H, W, 3].
        maps: The network's maps of the crop, [h, w] or [h, w, 3], and its mask of any size.
        decoded: The decoder's picture of these maps, sRGB [h, w, 3] in [0, 1].
        table: Colours of skin under the light and camera of the crop.
        shading_top: Largest shading.
        threads: Number of threads; None for all cores.

    Returns:
        Layers [H, W] or [H, W, 3].
    """
    height, width = crop.shape[:2]
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        changes = recover_detail(crop, maps, table, pool)
        layers = enlarge_layers(maps, decoded, width, height)
        for layer, change, top in zip(layers[:2], changes, table.top, strict=True):
            layer += resize(change, width, height)
            np.clip(layer, 0, top, out=layer)
        rows = max(1, _BLOCK // width)
        blocks = [slice(start, start + rows) for start in range(0, height, rows)]

        def fit_block(block: slice) -> None:
            _fit_in_place(layers.view_rows(block), crop[block], table, shading_top)

        # A list, so that an error in a block is raised.
        list(pool.map(fit_block, blocks))
    return layers


def _fit_in_place(
    layers: Layers, crop: NDArray[np.uint8], table: ColourTable, shading_top: float
) -> None:
    """Fit shading, specular, offset and reconstruction to some rows of the crop.

    Works in place: blocks of a large photograph are not copied.
    """
    weight = soften_mask(layers.mask)
    at = np.nonzero(weight)
    if not at[0].size:
        return
    share = weight[at]
    linear = srgb_to_linear(crop[at])
    skin = table(layers.melanin[at], layers.hemoglobin[at])
    offset, specular = layers.offset[at], layers.specular[at]
    specular -= share * np.maximum(specular - linear.min(-1), 0)
    diffuse = linear - specular[:, None]
    shading = _divide_luminances(diffuse - offset, skin, shading_top)
    shading = _blend(layers.shading[at], shading, share)
    skin *= shading[:, None]
    layers.shading[at] = shading
    layers.specular[at] = specular
    layers.offset[at] = _blend(offset, diffuse - skin, share[:, None])
    modelled = linear_to_srgb(skin + specular[:, None] + offset) * 255
    enlarged = layers.reconstruction[at].astype(np.float32)
    layers.reconstruction[at] = to_uint8(_blend(enlarged, modelled, share[:, None]) / 255)


def _divide_luminances(diffuse: Image, skin: Image, top: float) -> Image:
    """Luminance of diffuse light [pixels, 3] relative to that of skin [pixels, 3]."""
    shading: Image = (_luminance(diffuse) / np.maximum(_luminance(skin), 1e-4)).clip(0, top)
    return shading


def _luminance(linear: Image) -> Image:
    # Not a matrix product, whose rounding depends on the number of pixels.
    red, green, blue = linear.T
    weights = LUMINANCE_WEIGHTS
    luminance: Image = weights[0] * red + weights[1] * green + weights[2] * blue
    return luminance


def _blend(a: Image, b: Image, share: Image) -> Image:
    return a + share * (b - a)
