"""The panel of a decomposition: a photograph, its maps and its reconstruction."""

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._tiles import (
    GREY,
    SPECULAR,
    draw_grid,
    draw_offset,
    draw_picture,
    draw_pigment_map,
    draw_plain_map,
)
from skinnet.inference.decomposition import Decomposition


def draw_panel(photo: NDArray[np.uint8], decomposition: Decomposition) -> NDArray[np.uint8]:
    """Draw a photograph, its maps and its reconstruction in a grid of 4 x 2 tiles.

    Args:
        photo: The photograph that was decomposed, uint8 sRGB [H, W, 3].
        decomposition: Its decomposition.

    Returns:
        uint8 sRGB [806, 1290, 3].

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import draw_panel
        >>> draw_panel(astronaut(), Decomposer()(astronaut())).shape
        (806, 1290, 3)
    """
    box = decomposition.box.slices
    maps = {name: values[box] for name, values in decomposition.maps().items()}
    mask = maps["mask"]
    tiles = (
        draw_picture("photograph", photo[box]),
        draw_pigment_map("melanin", maps["melanin"], mask),
        draw_pigment_map("hemoglobin", maps["hemoglobin"], mask),
        draw_plain_map("shading", maps["shading"], "relative to the light", GREY),
        draw_picture("reconstruction", decomposition.reconstruction[box]),
        draw_plain_map("specular", maps["specular"], "relative to the light", SPECULAR),
        draw_plain_map("mask", mask, "probability of skin", GREY, top=1.0),
        draw_offset(decomposition.offset[box]),
    )
    return draw_grid(tiles, 4)
