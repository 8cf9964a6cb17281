"""Tiles of a panel: pictures and maps with captions and scales, and grids of them."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from skinnet.images.resizing import resize
from skinnet.images.srgb import to_uint8
from skinnet.inference.decomposition import SKIN_THRESHOLD

TILE = 300
"""Width and height, in pixels, of the picture in a tile."""

BLANK = (232, 232, 234)
"""sRGB of pixels without a value."""

_GAP, _CAPTION, _SCALE = 18, 30, 46
"""Space between tiles, and heights of a caption and a scale, in pixels."""

_INK, _PAPER, _OUTLINE = (38, 38, 40), (255, 255, 255), (150, 150, 152)

MELANIN = ((255, 243, 224), (233, 190, 140), (168, 104, 58), (92, 50, 28), (28, 16, 12))

HEMOGLOBIN = ((255, 255, 255), (255, 190, 180), (233, 80, 76), (160, 16, 34), (66, 2, 16))

GREY = ((0, 0, 0), (255, 255, 255))

SPECULAR = ((18, 20, 34), (60, 92, 150), (160, 200, 226), (255, 255, 255))

_Anchors = Sequence[tuple[int, int, int]]
"""Evenly spaced sRGB colours of a colour map."""

_PIGMENTS: dict[str, tuple[str, _Anchors]] = {
    "melanin": ("melanosome volume fraction", MELANIN),
    "hemoglobin": ("blood volume fraction", HEMOGLOBIN),
}


def draw_grid(tiles: Sequence[Image.Image], columns: int) -> NDArray[np.uint8]:
    """Draw tiles in a grid, row by row.

    Args:
        tiles: Tiles from `draw_picture` or `draw_pigment_map`.
        columns: Tiles in a row.

    Returns:
        uint8 sRGB [h, w, 3].

    Example:
        >>> import numpy as np
        >>> from skinnet.inference._tiles import draw_grid, draw_picture
        >>> tile = draw_picture("black", np.zeros((8, 8, 3), np.uint8))
        >>> draw_grid([tile] * 3, 2).shape
        (806, 654, 3)
    """
    grid = Image.new("RGB", _corner(columns, math.ceil(len(tiles) / columns)), _PAPER)
    for index, tile in enumerate(tiles):
        row, column = divmod(index, columns)
        grid.paste(tile, _corner(column, row))
    return np.array(grid)


def draw_picture(caption: str, pixels: NDArray[np.uint8]) -> Image.Image:
    """Draw a tile with a picture.

    Args:
        caption: The text above it.
        pixels: uint8 sRGB [h, w, 3] of any size.

    Returns:
        The tile.

    Example:
        >>> import numpy as np
        >>> from skinnet.inference._tiles import draw_picture
        >>> draw_picture("grey", np.full((50, 80, 3), 128, np.uint8)).size
        (300, 376)
    """
    return _draw_tile(caption, pixels)


def draw_pigment_map(
    name: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    top: float | None = None,
    caption: str | None = None,
) -> Image.Image:
    """Draw a tile with a map of a pigment, on a scale from 0.

    Args:
        name: "melanin" or "hemoglobin".
        values: Volume fractions [h, w].
        mask: Probability of skin [h, w]; the tile is blank where it is 0.
        top: End of the scale; by default a round number that at most 1 % of the skin exceeds.
        caption: The text above the map; the pigment's name by default.

    Returns:
        The tile.

    Example:
        >>> import numpy as np
        >>> from skinnet.inference._tiles import draw_pigment_map
        >>> draw_pigment_map("melanin", np.full((4, 4), 0.03), np.ones((4, 4))).size
        (300, 376)
    """
    return draw_map(caption or name, values, mask, *_PIGMENTS[name], top)


def round_up(value: float) -> float:
    """Round up to 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten, for the end of a scale."""
    if not value > 1e-6:
        return 1e-6
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if step * power >= value)


def draw_map(
    caption: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    unit: str,
    anchors: _Anchors,
    top: float | None = None,
) -> Image.Image:
    """A tile of values [h, w] on a scale from 0, blank where `mask` is 0."""
    top = _choose_top(values[mask > SKIN_THRESHOLD]) if top is None else top
    weight = np.clip(mask, 0, 1)[..., None]
    pixels = weight * _apply_colour_map(values / top, anchors) + (1 - weight) * np.array(BLANK)
    return _draw_tile(caption, pixels.astype(np.uint8), unit, anchors, top)


def draw_plain_map(
    name: str,
    values: NDArray[np.float32],
    unit: str,
    anchors: _Anchors,
    top: float | None = None,
) -> Image.Image:
    top = _choose_top(values) if top is None else top
    return _draw_tile(name, _apply_colour_map(values / top, anchors), unit, anchors, top)


def draw_offset(values: NDArray[np.float32]) -> Image.Image:
    top = _choose_top(np.abs(values))
    pixels = to_uint8(0.5 + 0.5 * values / top)
    return _draw_tile("offset", pixels, f"grey is 0, full colour ±{top:g} linear sRGB")


def _choose_top(values: NDArray[np.floating]) -> float:
    return round_up(float(np.percentile(values, 99))) if values.size else 1.0


def _apply_colour_map(values: NDArray[np.floating], anchors: _Anchors) -> NDArray[np.uint8]:
    """uint8 sRGB [..., 3] of values in [0, 1]."""
    stops = np.linspace(0, 1, len(anchors))
    channels = [np.interp(values, stops, channel) for channel in zip(*anchors, strict=True)]
    colours: NDArray[np.uint8] = np.rint(np.stack(channels, -1)).astype(np.uint8)
    return colours


def _corner(column: int, row: int) -> tuple[int, int]:
    return _GAP + column * (TILE + _GAP), _GAP + row * (_CAPTION + TILE + _SCALE + _GAP)


def _draw_tile(
    caption: str,
    pixels: NDArray[np.uint8],
    unit: str = "",
    anchors: _Anchors = (),
    top: float = 1.0,
) -> Image.Image:
    tile = Image.new("RGB", (TILE, _CAPTION + TILE + _SCALE), _PAPER)
    pen = ImageDraw.Draw(tile)
    pen.text((0, 2), caption, _INK, _load_font(20))
    tile.paste(_fit_square(pixels), (0, _CAPTION))
    below = _CAPTION + TILE + 6
    if anchors:
        ramp = np.linspace(0, 1, TILE, dtype=np.float32)[None].repeat(10, 0)
        tile.paste(Image.fromarray(_apply_colour_map(ramp, anchors)), (0, below))
        pen.rectangle((0, below, TILE - 1, below + 9), outline=_OUTLINE)
        pen.text((0, below + 15), "0", _INK, _load_font(15))
        pen.text((TILE - 1, below + 15), f"{top:g}", _INK, _load_font(15), anchor="ra")
        pen.text((TILE / 2, below + 15), unit, _INK, _load_font(15), anchor="ma")
    elif unit:
        pen.text((TILE / 2, below + 15), unit, _INK, _load_font(15), anchor="ma")
    return tile


def _fit_square(pixels: NDArray[np.uint8]) -> Image.Image:
    """The picture in the middle of a blank square, as large as it fits."""
    height, width = pixels.shape[:2]
    scale = TILE / max(height, width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    square = Image.new("RGB", (TILE, TILE), BLANK)
    corner = (TILE - size[0]) // 2, (TILE - size[1]) // 2
    square.paste(Image.fromarray(resize(pixels, *size)), corner)
    return square


def _load_font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
