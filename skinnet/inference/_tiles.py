"""Tiles of a panel: pictures and maps with captions and scales, and grids of them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from skinnet.images.resizing import resize
from skinnet.images.srgb import to_uint8
from skinnet.inference._colour_scales import PIGMENTS, Scale
from skinnet.inference.decomposition import SKIN_THRESHOLD

TILE = 300
"""Width and height, in pixels, of the picture in a tile."""

BLANK = (232, 232, 234)
"""sRGB of pixels without a value."""

_GAP, _CAPTION, _SCALE = 18, 30, 64
"""Space between tiles, and heights of a caption and a scale, in pixels."""

_BAR, _TICK, _LABELS, _MEASURE = 6, 16, 20, 40
"""Places of the bar, ticks, labels and measure of a scale, in pixels below the picture."""

_INK, _PAPER, _OUTLINE = (38, 38, 40), (255, 255, 255), (150, 150, 152)

_NOTED = 0.01
"""A tile says which share of the skin lies above its scale if it is larger than this."""


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
        (714, 654, 3)
    """
    rows = [tiles[start : start + columns] for start in range(0, len(tiles), columns)]
    height = sum(_find_height(row) for row in rows)
    grid = Image.new("RGB", (_GAP + columns * (TILE + _GAP), _GAP + height), _PAPER)
    top = _GAP
    for row in rows:
        for column, tile in enumerate(row):
            grid.paste(tile, (_GAP + column * (TILE + _GAP), top))
        top += _find_height(row)
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
        (300, 330)
    """
    return _draw_tile(caption, pixels)


def draw_pigment_map(
    name: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    caption: str | None = None,
    note: str = "",
) -> Image.Image:
    """Draw a tile with a map of a pigment, on the scale that all maps of this pigment have.

    Args:
        name: "melanin" or "hemoglobin".
        values: Volume fractions [h, w]; the scale shows them in percent.
        mask: Probability of skin [h, w]; the tile is blank where it is 0.
        caption: The text above the map; the pigment's name by default.
        note: A smaller text beside the caption, such as the mean.

    Returns:
        The tile.

    Example:
        >>> import numpy as np
        >>> from skinnet.inference._tiles import draw_pigment_map
        >>> draw_pigment_map("melanin", np.full((4, 4), 0.03), np.ones((4, 4))).size
        (300, 394)
    """
    return draw_map(caption or name, values, mask, PIGMENTS[name], note)


def draw_map(
    caption: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    scale: Scale,
    note: str = "",
) -> Image.Image:
    """Draw a tile of values [h, w], blank where `mask` is 0, with a note beside the caption."""
    colours = colour_small_map(values, mask, scale, *_fit_size(*values.shape))
    skin = values[mask > SKIN_THRESHOLD]
    notes = [each for each in (note, _note_excess(skin, scale)) if each]
    return _draw_tile(caption, colours, scale, "\n".join(notes))


def colour_small_map(
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    scale: Scale,
    width: int,
    height: int,
) -> NDArray[np.uint8]:
    """Colour values [h, w] at a smaller size, blank where `mask` is 0; uint8 [height, width, 3]."""
    share = np.clip(mask, 0, 1).astype(np.float32)
    weight = resize(share, width, height)
    # Values are averaged over skin alone, before they are coloured: a large map costs little.
    sums = resize(np.where(share > 0, values, 0).astype(np.float32) * share, width, height)
    mean = sums / np.maximum(weight, 1e-6)
    colours = weight[..., None] * scale.colour(mean) + (1 - weight[..., None]) * np.array(BLANK)
    small: NDArray[np.uint8] = colours.astype(np.uint8)
    return small


def draw_plain_map(
    caption: str, values: NDArray[np.float32], mask: NDArray[np.floating], scale: Scale
) -> Image.Image:
    """Draw a tile of values [h, w], also where there is no skin."""
    colours = scale.colour(resize(values, *_fit_size(*values.shape)))
    return _draw_tile(caption, colours, scale, _note_excess(values[mask > SKIN_THRESHOLD], scale))


def draw_offset(values: NDArray[np.float32]) -> Image.Image:
    """Draw a tile of an offset, linear sRGB [h, w, 3], on grey."""
    size = _fit_size(*values.shape[:2])
    small = np.stack([resize(values[..., channel], *size) for channel in range(3)], -1)
    picture = _draw_tile("offset", to_uint8(0.5 + 0.5 * small))
    tile = Image.new("RGB", (TILE, picture.height + _SCALE), _PAPER)
    tile.paste(picture)
    _write(tile, _LABELS, "linear sRGB")
    _write(tile, _MEASURE, "grey is 0, full colour ±100 %")
    return tile


def draw_scale(scale: Scale) -> NDArray[np.uint8]:
    """Draw a scale with its labels alone, uint8 sRGB [h, w, 3]."""
    tile = Image.new("RGB", (TILE, _CAPTION + TILE + _SCALE), _PAPER)
    _draw_scale(tile, scale)
    return np.array(tile.crop((0, _CAPTION + TILE, *tile.size)))


def place_labels(scale: Scale) -> list[tuple[str, float, float]]:
    """Place the labels of a scale: each with its left and right end, in pixels of the tile."""
    font, placed = _load_font(15), []
    for text, place in scale.label():
        width = font.getlength(text)
        left = min(max(place * TILE - width / 2, 0.0), TILE - width)
        placed.append((text, left, left + width))
    return placed


def _note_excess(values: NDArray[np.floating], scale: Scale) -> str:
    """The share of values above the scale in words, if it is to be noted."""
    top = scale.ticks[-1]
    share = float(np.mean(values * scale.factor > top)) if values.size else 0.0
    return f"{100 * share:.0f} % above {top:g} {scale.symbol}" if share > _NOTED else ""


def _find_height(row: Sequence[Image.Image]) -> int:
    """The height of a row, with the gap below it; tiles without a scale are lower."""
    return max(tile.height for tile in row) + _GAP


def _draw_tile(
    caption: str, pixels: NDArray[np.uint8], scale: Scale | None = None, note: str = ""
) -> Image.Image:
    below = 0 if scale is None else _SCALE
    tile = Image.new("RGB", (TILE, _CAPTION + TILE + below), _PAPER)
    pen = ImageDraw.Draw(tile)
    pen.text((0, 2), caption, _INK, _load_font(20))
    size, top = (12, 0) if "\n" in note else (15, 7)
    place = (TILE - 1, top)
    pen.multiline_text(place, note, _INK, _load_font(size), anchor="ra", align="right", spacing=2)
    tile.paste(_fit_square(pixels), (0, _CAPTION))
    if scale is not None:
        _draw_scale(tile, scale)
    return tile


def _draw_scale(tile: Image.Image, scale: Scale) -> None:
    below, pen = _CAPTION + TILE, ImageDraw.Draw(tile)
    places = np.linspace(0, 1, TILE, dtype=np.float32)
    bar = scale.ramp(places)[None].repeat(10, 0)
    tile.paste(Image.fromarray(bar), (0, below + _BAR))
    pen.rectangle((0, below + _BAR, TILE - 1, below + _BAR + 9), outline=_OUTLINE)
    for _, place in scale.label():
        x = round(place * (TILE - 1))
        pen.line((x, below + _TICK, x, below + _TICK + 3), _INK)
    for text, left, _ in place_labels(scale):
        pen.text((left, below + _LABELS), text, _INK, _load_font(15))
    _write(tile, _MEASURE, scale.measure)


def _write(tile: Image.Image, below: int, text: str) -> None:
    """Write a line in the middle, `below` pixels below the picture."""
    pen = ImageDraw.Draw(tile)
    pen.text((TILE / 2, _CAPTION + TILE + below), text, _INK, _load_font(15), anchor="ma")


def _fit_size(height: int, width: int) -> tuple[int, int]:
    """The width and height of a picture that fits a tile."""
    scale = TILE / max(height, width)
    return max(1, round(width * scale)), max(1, round(height * scale))


def _fit_square(pixels: NDArray[np.uint8]) -> Image.Image:
    """The picture in the middle of a blank square, as large as it fits."""
    size = _fit_size(*pixels.shape[:2])
    square = Image.new("RGB", (TILE, TILE), BLANK)
    corner = (TILE - size[0]) // 2, (TILE - size[1]) // 2
    square.paste(Image.fromarray(resize(pixels, *size)), corner)
    return square


def _load_font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
