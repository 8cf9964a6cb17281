"""Forest plots: what several shots or regions say of a pigment, and how sure each of them is."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw

from skinnet.inference._colour_scales import PIGMENTS
from skinnet.inference._tiles import TILE, _draw_tile, _load_font

_MOST_ROWS = 20
"""Rows that can be read; of more, the first are drawn and the last."""

_HIGHEST_ROW, _TEXT, _DOT = 28, 12, 4
_INK, _PALE, _PAPER = (38, 38, 40), (170, 170, 172), (255, 255, 255)


class PlotRow(NamedTuple):
    """A row of a forest plot.

    Attributes:
        label: What it is of.
        mean: Volume fraction; None if nothing is known.
        interval: Fractions between which the true mean lies.
        weight: 0 for what was left out, 1 for a row, 2 for the fused one.
    """

    label: str
    mean: float | None
    interval: Sequence[float] | None
    weight: int = 1


def draw_forest_plot(
    name: str, caption: str, rows: Sequence[PlotRow], note: str = ""
) -> Image.Image:
    """Draw a tile with means and intervals above the scale that all maps of a pigment have.

    Args:
        name: "melanin" or "hemoglobin".
        caption: The text above the plot.
        rows: From top to bottom.
        note: A smaller text beside the caption.

    Returns:
        The tile.
    """
    shown = rows if len(rows) <= _MOST_ROWS else [*rows[: _MOST_ROWS - 1], rows[-1]]
    height = min(_HIGHEST_ROW, TILE // len(shown))
    plot = Image.new("RGB", (TILE, TILE), _PAPER)
    for number, row in enumerate(shown):
        _draw_row(ImageDraw.Draw(plot), name, row, height * number + height // 2)
    return _draw_tile(caption, np.array(plot), PIGMENTS[name], note)


def _draw_row(pen: ImageDraw.ImageDraw, name: str, row: PlotRow, y: int) -> None:
    ink = _INK if row.weight else _PALE
    right = 0.0
    if row.mean is not None and row.interval is not None:
        low, middle, right = _place(name, (row.interval[0], row.mean, row.interval[1]))
        pen.line((low, y, right, y), ink, max(1, 2 * row.weight - 1))
        pen.ellipse((middle - _DOT, y - _DOT, middle + _DOT, y + _DOT), ink)
        beside = low
    else:
        beside = TILE
    font = _load_font(_TEXT)
    if font.getlength(row.label) + 2 * _DOT < beside:
        pen.text((0, y), row.label, ink, font, anchor="lm")
    else:
        pen.text((right + 2 * _DOT, y), row.label, ink, font, anchor="lm")


def _place(name: str, fractions: Sequence[float]) -> list[float]:
    """Pixels of fractions from the left."""
    places = PIGMENTS[name].place(np.array(fractions)).clip(0, 1)
    return [float(place) * (TILE - 1) for place in places]
