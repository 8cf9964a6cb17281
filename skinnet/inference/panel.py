"""The panel of a decomposition: a photograph, its maps and its reconstruction."""

import numpy as np
from numpy.typing import NDArray

from skinnet.inference._colour_scales import MASK, SHADING, SPECULAR
from skinnet.inference._tiles import (
    draw_grid,
    draw_offset,
    draw_picture,
    draw_pigment_map,
    draw_plain_map,
)
from skinnet.inference.decomposition import Decomposition


def draw_panel(photo: NDArray[np.uint8], decomposition: Decomposition) -> NDArray[np.uint8]:
    """Draw a photograph, its maps and its reconstruction in a grid of 4 x 2 tiles.

    Colour scales are fixed and in percent, so that the panels of two people can be compared. Values
    above the end of a scale have its last colour; a tile says so if they are more than 1 % of the
    skin.

    Args:
        photo: The photograph that was decomposed, uint8 sRGB [H, W, 3].
        decomposition: Its decomposition.

    Returns:
        uint8 sRGB [842, 1290, 3].

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import draw_panel
        >>> draw_panel(astronaut(), Decomposer()(astronaut())).shape
        (842, 1290, 3)
    """
    box = decomposition.box.slices
    maps = {name: values[box] for name, values in decomposition.maps().items()}
    mask = maps["mask"]
    tiles = (
        draw_picture("photograph", photo[box]),
        draw_pigment_map("melanin", maps["melanin"], mask),
        draw_pigment_map("hemoglobin", maps["hemoglobin"], mask),
        draw_plain_map("shading", maps["shading"], mask, SHADING),
        draw_picture("reconstruction", decomposition.reconstruction[box]),
        draw_plain_map("specular", maps["specular"], mask, SPECULAR),
        draw_plain_map("mask", mask, mask, MASK),
        draw_offset(decomposition.offset[box]),
    )
    return draw_grid(tiles, 4)
