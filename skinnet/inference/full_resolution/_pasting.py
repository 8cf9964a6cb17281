"""Layers of a crop, pasted where the crop lies in the photograph."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images.box import Box
from skinnet.inference.full_resolution._layers import Layers


def paste_layers(
    layers: Layers, photo: NDArray[np.uint8], box: Box, inside: NDArray[np.bool_]
) -> dict[str, NDArray[Any]]:
    """Paste the layers of a box at those of its pixels that are inside what was read.

    Elsewhere maps are 0, and the reconstruction is the photograph, uint8 sRGB [H, W, 3].
    """
    is_all_inside = bool(inside.all())
    if is_all_inside and (box.height, box.width) == photo.shape[:2]:
        return layers._asdict()
    pasted: dict[str, NDArray[Any]] = {}
    for name, layer in layers._asdict().items():
        shape = (*photo.shape[:2], *layer.shape[2:])
        pasted[name] = photo.copy() if name == "reconstruction" else np.zeros(shape, layer.dtype)
        part = ... if is_all_inside else inside
        pasted[name][box.slices][part] = layer[part]
    return pasted
