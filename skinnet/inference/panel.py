"""One picture of a decomposition: photograph, maps and reconstruction, with captions and scales."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from skinnet.images.resizing import resize
from skinnet.images.srgb import to_uint8
from skinnet.inference.decomposition import SKIN_THRESHOLD, Decomposition

TILE = 300
"""Width and height of a picture in the panel, in pixels."""

_GAP, _CAPTION, _SCALE = 18, 30, 46
_INK, _PAPER, BLANK = (38, 38, 40), (255, 255, 255), (232, 232, 234)

_MELANIN = ((255, 243, 224), (233, 190, 140), (168, 104, 58), (92, 50, 28), (28, 16, 12))
_HEMOGLOBIN = ((255, 255, 255), (255, 190, 180), (233, 80, 76), (160, 16, 34), (66, 2, 16))
_GREY = ((0, 0, 0), (255, 255, 255))
_GLOSS = ((18, 20, 34), (60, 92, 150), (160, 200, 226), (255, 255, 255))

Anchors = Sequence[tuple[int, int, int]]

_PIGMENTS: dict[str, tuple[str, Anchors]] = {
    "melanin": ("melanosome volume fraction", _MELANIN),
    "hemoglobin": ("blood volume fraction", _HEMOGLOBIN),
}


def draw_panel(photo: NDArray[np.uint8], decomposition: Decomposition) -> NDArray[np.uint8]:
    """The box of a photograph and of its decomposition in a 4 x 2 grid, uint8 sRGB [h, w, 3].

    `photo` is the uint8 sRGB [H, W, 3] that was decomposed. Melanin and hemoglobin are shown where
    there is skin, each on a scale from zero to a round number above nearly all of its values.
    """
    tiles = (
        draw_picture("photograph", photo[decomposition.box.slices]),
        pigment(decomposition, "melanin"),
        pigment(decomposition, "hemoglobin"),
        _plain_map(decomposition, "shading", "relative to the light", _GREY),
        draw_picture("reconstruction", decomposition.reconstruction[decomposition.box.slices]),
        _plain_map(decomposition, "specular", "relative to the light", _GLOSS),
        _plain_map(decomposition, "mask", "how surely skin", _GREY),
        _offset(decomposition),
    )
    return draw_grid(tiles, 4)


def draw_grid(tiles: Sequence[Image.Image], columns: int) -> NDArray[np.uint8]:
    """Tiles in rows of that many, uint8 sRGB [h, w, 3]."""
    paper = Image.new("RGB", _corner(columns, math.ceil(len(tiles) / columns)), _PAPER)
    for index, tile in enumerate(tiles):
        row, column = divmod(index, columns)
        paper.paste(tile, _corner(column, row))
    return np.array(paper)


def colour_map(values: NDArray[np.floating], anchors: Anchors) -> NDArray[np.uint8]:
    """uint8 sRGB [..., 3] of values in [0, 1] along evenly spaced anchor colours."""
    stops = np.linspace(0, 1, len(anchors))
    channels = [np.interp(values, stops, channel) for channel in zip(*anchors, strict=True)]
    colours: NDArray[np.uint8] = np.rint(np.stack(channels, -1)).astype(np.uint8)
    return colours


def round_up(value: float) -> float:
    """The least of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is at least `value`."""
    if not value > 1e-6:
        return 1e-6
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if step * power >= value)


def _corner(column: int, row: int) -> tuple[int, int]:
    return _GAP + column * (TILE + _GAP), _GAP + row * (_CAPTION + TILE + _SCALE + _GAP)


def pigment(decomposition: Decomposition, name: str) -> Image.Image:
    """A tile of `melanin` or `hemoglobin` on skin, with its scale."""
    values = decomposition.maps()[name][decomposition.box.slices]
    return draw_pigment_map(name, values, decomposition.mask[decomposition.box.slices])


def draw_pigment_map(
    name: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    top: float | None = None,
    caption: str | None = None,
) -> Image.Image:
    """A tile of `melanin` or `hemoglobin` values [h, w], blank where `mask` is 0.

    The scale ends at `top`, or at a round number above nearly all values.
    """
    return _draw_map(caption or name, values, mask, *_PIGMENTS[name], top)


def _draw_map(
    caption: str,
    values: NDArray[np.floating],
    mask: NDArray[np.floating],
    unit: str,
    anchors: Anchors,
    top: float | None = None,
) -> Image.Image:
    """A tile of values [h, w] from 0 up along anchor colours, blank where `mask` is 0."""
    top = _top(values[mask > SKIN_THRESHOLD]) if top is None else top
    weight = np.clip(mask, 0, 1)[..., None]
    shown = weight * colour_map(values / top, anchors) + (1 - weight) * np.array(BLANK)
    return _tile(caption, shown.astype(np.uint8), unit, anchors, top)


def _plain_map(decomposition: Decomposition, name: str, unit: str, anchors: Anchors) -> Image.Image:
    values = decomposition.maps()[name][decomposition.box.slices]
    top = 1.0 if name == "mask" else _top(values)
    return _tile(name, colour_map(values / top, anchors), unit, anchors, top)


def _offset(decomposition: Decomposition) -> Image.Image:
    values = decomposition.offset[decomposition.box.slices]
    top = _top(np.abs(values))
    shown = to_uint8(0.5 + 0.5 * values / top)
    note = f"grey is 0, full colour ±{top:g} linear sRGB"
    return _tile("offset", shown, note)


def _top(values: NDArray[np.floating]) -> float:
    return round_up(float(np.percentile(values, 99))) if values.size else 1.0


def draw_picture(caption: str, pixels: NDArray[np.uint8]) -> Image.Image:
    """A tile of a picture, uint8 sRGB [h, w, 3]."""
    return _tile(caption, pixels)


def _tile(
    caption: str,
    picture: NDArray[np.uint8],
    unit: str = "",
    anchors: Anchors = (),
    top: float = 1.0,
) -> Image.Image:
    tile = Image.new("RGB", (TILE, _CAPTION + TILE + _SCALE), _PAPER)
    pen = ImageDraw.Draw(tile)
    pen.text((0, 2), caption, _INK, _font(20))
    tile.paste(_fitted(picture), (0, _CAPTION))
    below = _CAPTION + TILE + 6
    if anchors:
        bar = colour_map(np.linspace(0, 1, TILE, dtype=np.float32)[None].repeat(10, 0), anchors)
        tile.paste(Image.fromarray(bar), (0, below))
        pen.rectangle((0, below, TILE - 1, below + 9), outline=(150, 150, 152))
        pen.text((0, below + 15), "0", _INK, _font(15))
        pen.text((TILE - 1, below + 15), f"{top:g}", _INK, _font(15), anchor="ra")
        pen.text((TILE / 2, below + 15), unit, _INK, _font(15), anchor="ma")
    elif unit:
        pen.text((TILE / 2, below + 15), unit, _INK, _font(15), anchor="ma")
    return tile


def _fitted(picture: NDArray[np.uint8]) -> Image.Image:
    """The picture as large as it fits into a square tile, in its middle."""
    height, width = picture.shape[:2]
    scale = TILE / max(height, width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    square = Image.new("RGB", (TILE, TILE), BLANK)
    corner = (TILE - size[0]) // 2, (TILE - size[1]) // 2
    square.paste(Image.fromarray(resize(picture, *size)), corner)
    return square


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
