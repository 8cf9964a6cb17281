"""The panel of a decomposition: a photograph, its maps and its reconstruction."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.images._arguments import check_photo
from skinnet.images.resizing import resize
from skinnet.inference._colour_scales import MASK, SHADING, SPECULAR, UNCERTAINTY
from skinnet.inference._tiles import (
    draw_grid,
    draw_map,
    draw_offset,
    draw_picture,
    draw_pigment_map,
    draw_plain_map,
)
from skinnet.inference._uncertainty import PIGMENTS, describe_percent
from skinnet.inference.decomposition import Decomposition


def draw_panel(photo: NDArray[np.uint8], decomposition: Decomposition) -> NDArray[np.uint8]:
    """Draw a photograph, its maps and its reconstruction in a grid of 5 x 2 tiles.

    Colour scales are fixed and in percent, so that the panels of two people can be compared. Values
    above the end of a scale have its last colour; a tile says so if they are more than 1 % of the
    skin. Beside the names of the pigments are their means over the skin, with the 90 % intervals.

    Args:
        photo: The photograph that was decomposed, uint8 sRGB [H, W, 3].
        decomposition: Its decomposition.

    Returns:
        uint8 sRGB [842, 1608, 3].

    Raises:
        InputError: The photograph has another shape or type than that which was decomposed.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import draw_panel
        >>> draw_panel(astronaut(), Decomposer()(astronaut())).shape
        (842, 1608, 3)
    """
    if check_photo(photo).shape[:2] != decomposition.mask.shape:
        height, width = decomposition.mask.shape
        raise InputError(
            f"The photograph of this decomposition has {width} x {height} pixels; got one of "
            f"{photo.shape[1]} x {photo.shape[0]}."
        )
    box = decomposition.box.slices
    mask = decomposition.mask[box]
    tiles = (
        draw_picture("photograph", photo[box]),
        *(_draw_pigment(decomposition, name) for name in PIGMENTS),
        draw_plain_map("shading", decomposition.shading[box], mask, SHADING),
        draw_plain_map("specular", decomposition.specular[box], mask, SPECULAR),
        draw_picture("reconstruction", decomposition.reconstruction[box]),
        *(_draw_uncertainty(decomposition, name) for name in PIGMENTS),
        draw_plain_map("mask", mask, mask, MASK),
        draw_offset(decomposition.offset[box]),
    )
    return draw_grid(tiles, 5)


def _draw_pigment(decomposition: Decomposition, name: str) -> Image.Image:
    box = decomposition.box.slices
    values, mask = getattr(decomposition, name)[box], decomposition.mask[box]
    return draw_pigment_map(name, values, mask, note=_describe_mean(decomposition, name))


def _draw_uncertainty(decomposition: Decomposition, name: str) -> Image.Image:
    log_sd = decomposition.uncertainty.of_pixels(name)
    mask = resize(decomposition.mask[decomposition.box.slices], *log_sd.shape[::-1])
    return draw_map(f"uncertainty of {name}", log_sd, mask, UNCERTAINTY)


def _describe_mean(decomposition: Decomposition, name: str) -> str:
    """A mean and its interval in percent."""
    if name not in decomposition.means:
        return ""
    return describe_percent(decomposition.means[name], decomposition.interval()[name])
