"""The panel of a tracked video."""

import itertools

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from skinnet.inference._tiles import BLANK, _load_font
from skinnet.video._map_frame import colour_blood, colour_change
from skinnet.video._readings import QUANTILE
from skinnet.video._regions import NAMES
from skinnet.video.track import Track

_WIDTH, _GAP, _TILE, _HEAD = 1200, 24, 270, 30
_PLOT = 360
_INK, _PAPER, _GREY = (38, 38, 40), (255, 255, 255), (210, 210, 212)
_COLOURS = {
    "face": (38, 38, 40),
    "forehead": (0, 114, 178),
    "left_cheek": (213, 94, 0),
    "right_cheek": (204, 121, 167),
    "nose": (0, 158, 115),
    "lips": (200, 30, 45),
    "chin": (150, 120, 40),
}
"""The colours of Okabe and Ito, which all readers tell apart, and red for the lips."""

_SHOWN = 0.08
"""Least height of the plot: log changes on either side of 0."""


def draw_track(track: Track) -> NDArray[np.uint8]:
    """Draw face, maps and the course of the blood over time, uint8 sRGB [h, w, 3]."""
    height = _GAP + _HEAD + _TILE + _GAP + _HEAD + _PLOT + 90
    panel = Image.new("RGB", (_WIDTH, height), _PAPER)
    for place, (caption, pixels) in enumerate(_list_tiles(track)):
        _paste_tile(panel, place, caption, pixels)
    _write_numbers(panel, track)
    _draw_course(panel, track, _GAP + _HEAD + _TILE + _GAP)
    return np.array(panel)


def _list_tiles(track: Track) -> list[tuple[str, NDArray[np.uint8]]]:
    blank = np.full((8, 8, 3), BLANK, np.uint8)
    portrait = blank if track._portrait is None else track._portrait
    resting = blank if track._resting is None else colour_blood(track._resting)
    if track._peak is None:
        return [("face at rest", portrait), ("hemoglobin at rest", resting)]
    time, texture = track._peak
    changed = colour_change(texture)
    return [
        ("face at rest", portrait),
        ("hemoglobin at rest", resting),
        (f"largest change, at {time:.1f} s", changed),
    ]


def _paste_tile(panel: Image.Image, place: int, caption: str, pixels: NDArray[np.uint8]) -> None:
    left = _GAP + place * (_TILE + _GAP)
    ImageDraw.Draw(panel).text((left, _GAP), caption, _INK, _load_font(16))
    picture = Image.fromarray(pixels).resize((_TILE, _TILE), Image.Resampling.BILINEAR)
    panel.paste(picture, (left, _GAP + _HEAD))


def _write_numbers(panel: Image.Image, track: Track) -> None:
    draw, left, top = ImageDraw.Draw(panel), _GAP + 3 * (_TILE + _GAP), _GAP
    for number, line in enumerate(_describe(track)):
        draw.text((left, top + 22 * number), line, _INK, _load_font(15))


def _describe(track: Track) -> list[str]:
    lines = []
    for name, summary in (
        ("melanin", track.melanin["face"]),
        ("hemoglobin at rest", track.resting_hemoglobin["face"]),
    ):
        if summary["mean"] is not None:
            low, high = summary["interval"]
            lines += [
                f"{name} {100 * summary['mean']:.2g} %",
                f"  90 %: {100 * low:.2g} to {100 * high:.2g} %",
            ]
    pulse = track.pulse
    if pulse["rate_bpm"] is not None:
        lines.append(f"pulse {pulse['rate_bpm']:.0f} per minute")
    else:
        lines.append("pulse: not readable" if pulse["estimates"] else "pulse: too short")
    if pulse["quality"] is not None:
        lines.append(f"  quality {pulse['quality']:.2f}")
    faces = [event for event in track.events if event.region == "face"]
    lines.append(f"{len(faces)} events of the face" if len(faces) != 1 else "1 event of the face")
    for event in faces[:4]:
        size = 100 * (np.exp(event.log_ratio) - 1)
        lines.append(f"  {event.kind} at {event.onset:.1f} s, {size:+.0f} %")
    return [*lines, "not a medical device"]


def _draw_course(panel: Image.Image, track: Track, top: int) -> None:
    """Draw the log ratios of all regions over time, with the 90 % interval of the face."""
    draw = ImageDraw.Draw(panel, "RGBA")
    draw.text((_GAP, top), "hemoglobin since the baseline", _INK, _load_font(16))
    box = (_GAP + 56, top + _HEAD, _WIDTH - _GAP, top + _HEAD + _PLOT)
    rows = track._trace
    if not len(rows):
        return
    times, changes = rows[:, 0], rows[:, 1 : 1 + len(NAMES)]
    sds = rows[:, 1 + len(NAMES) :]
    half = QUANTILE * sds[:, 0]
    ends = np.stack([changes[:, 0] - half, changes[:, 0] + half])
    reach = max(_SHOWN, 1.1 * _find_reach(changes), 1.05 * _find_reach(ends))
    scale = _Axes(box, float(times[0]), max(float(times[-1]), float(times[0]) + 1e-3), reach)
    _draw_grid(draw, scale)
    _draw_band(draw, scale, times, changes[:, 0], half)
    for event in track.events:
        if event.region == "face":
            x = scale.x(event.onset)
            draw.line((x, box[1], x, box[3]), fill=(120, 120, 122, 255))
            draw.text((x + 3, box[1] + 2), event.kind, (90, 90, 92), _load_font(12))
    for index in (*range(1, len(NAMES)), 0):
        _draw_line(draw, scale, times, changes[:, index], _COLOURS[NAMES[index]], 3 - (index > 0))
    _draw_legend(draw, box)


def _find_reach(changes: NDArray[np.float64]) -> float:
    seen = np.abs(changes[np.isfinite(changes)])
    return float(np.percentile(seen, 99.5)) if seen.size else 0.0


class _Axes:
    """Places of times and log changes in a box of pixels."""

    def __init__(
        self, box: tuple[int, int, int, int], start: float, end: float, reach: float
    ) -> None:
        self.box, self.start, self.end, self.reach = box, start, end, reach

    def x(self, time: float) -> float:
        """Column of a time."""
        left, _, right, _ = self.box
        return left + (time - self.start) / (self.end - self.start) * (right - left)

    def y(self, change: float) -> float:
        """Row of a log change."""
        _, top, _, bottom = self.box
        middle = (top + bottom) / 2
        return middle - float(np.clip(change / self.reach, -1, 1)) * (bottom - top) / 2


def _draw_grid(draw: ImageDraw.ImageDraw, scale: _Axes) -> None:
    left, top, right, bottom = scale.box
    font = _load_font(12)
    for share in (-1.0, -0.5, 0.0, 0.5, 1.0):
        y = scale.y(share * scale.reach)
        draw.line((left, y, right, y), fill=_GREY)
        text = f"{100 * (np.exp(share * scale.reach) - 1):+.0f} %" if share else "0 %"
        draw.text((left - 8, y), text, _INK, font, anchor="rm")
    for time in np.linspace(scale.start, scale.end, 8):
        draw.text((scale.x(float(time)), bottom + 12), f"{time:.1f} s", _INK, font, anchor="mm")
    draw.rectangle((left, top, right, bottom), outline=_GREY)


def _draw_band(
    draw: ImageDraw.ImageDraw,
    scale: _Axes,
    times: NDArray[np.float64],
    middle: NDArray[np.float64],
    half: NDArray[np.float64],
) -> None:
    # One polygon for each run of readings: where polygons meet, their tints would add up.
    known = np.flatnonzero(np.isfinite(middle) & np.isfinite(half))
    for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
        if len(run) > 1:
            upper, lower = (
                [(scale.x(t), scale.y(v)) for t, v in zip(times[run], edge[run], strict=True)]
                for edge in (middle + half, middle - half)
            )
            draw.polygon([*upper, *lower[::-1]], fill=(*_COLOURS["face"], 40))


def _draw_line(
    draw: ImageDraw.ImageDraw,
    scale: _Axes,
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    colour: tuple[int, int, int],
    width: int,
) -> None:
    points = [(scale.x(t), scale.y(v)) if np.isfinite(v) else None
              for t, v in zip(times, values, strict=True)]  # fmt: skip
    for start, end in itertools.pairwise(points):
        if start is not None and end is not None:
            draw.line((*start, *end), fill=(*colour, 255), width=width)


def _draw_legend(draw: ImageDraw.ImageDraw, box: tuple[int, int, int, int]) -> None:
    left, _, _, bottom = box
    for index, name in enumerate(NAMES):
        x, y = left + index * 150, bottom + 40
        draw.line((x, y, x + 24, y), fill=_COLOURS[name], width=4)
        draw.text((x + 32, y), name.replace("_", " "), _INK, _load_font(14), anchor="lm")
