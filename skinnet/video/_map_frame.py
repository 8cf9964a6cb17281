"""Frames of the video of the map: hemoglobin, and its change since the baseline."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from skinnet.inference._colour_scales import HEMOGLOBIN, Scale
from skinnet.inference._tiles import BLANK, _load_font
from skinnet.video._readings import Reading

SIDE, _HEAD, _FOOT = 288, 28, 44
LARGEST_CHANGE = 0.6
"""Log change at the ends of the scale of changes."""

_INK, _PAPER = (38, 38, 40), (255, 255, 255)

_CHANGE = (
    (5, 48, 97), (33, 102, 172), (67, 147, 195), (146, 197, 222), (209, 229, 240), (247, 247, 247),
    (253, 219, 199), (244, 165, 130), (214, 96, 77), (178, 24, 43), (103, 0, 31),
)  # fmt: skip
"""Blue is less blood, white the same, red more (ColorBrewer's RdBu)."""


def colour_change(change: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Colour log changes, uint8 sRGB [..., 3]; grey where there is none."""
    places = np.clip(np.nan_to_num(change) / (2 * LARGEST_CHANGE) + 0.5, 0, 1)
    stops = np.linspace(0, 1, len(_CHANGE))
    channels = [np.interp(places, stops, one) for one in zip(*_CHANGE, strict=True)]
    colours: NDArray[np.uint8] = np.rint(np.stack(channels, -1)).astype(np.uint8)
    colours[~np.isfinite(change)] = BLANK
    return colours


def colour_blood(blood: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Colour volume fractions on the scale of all panels; grey where there is none."""
    colours = HEMOGLOBIN.colour(np.nan_to_num(blood))
    colours[~np.isfinite(blood)] = BLANK
    return colours


def draw_map_frame(reading: Reading) -> NDArray[np.uint8]:
    """Draw both maps of a reading, with time and scales."""
    assert reading.texture is not None and reading.resting is not None
    blood = colour_blood(reading.resting * np.exp(reading.texture))
    change = colour_change(reading.texture)
    frame = Image.new("RGB", (2 * SIDE, _HEAD + SIDE + _FOOT), _PAPER)
    for place, pixels in enumerate((blood, change)):
        picture = Image.fromarray(pixels).resize((SIDE, SIDE), Image.Resampling.BILINEAR)
        frame.paste(picture, (place * SIDE, _HEAD))
    draw, font = ImageDraw.Draw(frame), _load_font(13)
    draw.text((8, 6), f"hemoglobin, {reading.time:.2f} s", _INK, font)
    draw.text((SIDE + 8, 6), "change since the baseline", _INK, font)
    _draw_blood_scale(frame, HEMOGLOBIN)
    _draw_change_scale(frame)
    return np.array(frame)


def _draw_blood_scale(frame: Image.Image, scale: Scale) -> None:
    ramp = scale.ramp(np.linspace(0, 1, SIDE - 40))[None].repeat(10, 0)
    top = _HEAD + SIDE + 6
    frame.paste(Image.fromarray(ramp), (20, top))
    draw, font = ImageDraw.Draw(frame), _load_font(11)
    for text, place in scale.label():
        draw.text((20 + place * (SIDE - 40), top + 22), text, _INK, font, anchor="mm")


def _draw_change_scale(frame: Image.Image) -> None:
    ends = LARGEST_CHANGE * np.linspace(-1, 1, SIDE - 40)
    ramp = colour_change(ends)[None].repeat(10, 0)
    top = _HEAD + SIDE + 6
    frame.paste(Image.fromarray(ramp), (SIDE + 20, top))
    draw, font = ImageDraw.Draw(frame), _load_font(11)
    for share in (-1.0, -0.5, 0.0, 0.5, 1.0):
        text = f"{100 * (np.exp(share * LARGEST_CHANGE) - 1):+.0f} %" if share else "0 %"
        place = SIDE + 20 + (share + 1) / 2 * (SIDE - 40)
        draw.text((place, top + 22), text, _INK, font, anchor="mm")
