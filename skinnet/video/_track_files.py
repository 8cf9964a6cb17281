"""The files of a tracked video: a table that grows with it, a video of the map, a summary."""

import csv
import errno
import json
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from skinnet.errors import InputError, _explain_fault
from skinnet.images._mark import Mark
from skinnet.images._png_file import write_png
from skinnet.inference._uncertainty import find_factor
from skinnet.video._map_frame import draw_map_frame
from skinnet.video._pulse import LEAST_QUALITY, PulseEstimate
from skinnet.video._readings import Reading
from skinnet.video._regions import NAMES
from skinnet.video._video_frames import _import_av
from skinnet.video.track import Track

TABLE, SUMMARY, PANEL, MAPS = ".csv", ".json", ".png", ".mp4"
ENDS = (TABLE, SUMMARY, PANEL, MAPS)

_FIELDS = ("hemoglobin", "hemoglobin_low", "hemoglobin_high", "log_ratio", "log_ratio_sd")
COLUMNS = (
    "frame",
    "time",
    "shot",
    "state",
    "gain",
    *(f"{name}_{field}" for name in NAMES for field in _FIELDS),
    "pulse_bpm",
    "pulse_quality",
)
"""Columns of the table; low and high are the ends of the 90 % interval."""

_TICKS = 1000
_LEVEL = 0.9


class TrackFiles:
    """Writes results while a video is read, to temporary files.

    Args:
        table: Where to write the table.
        maps: Where to write the video of the map; None for no such video.
    """

    def __init__(self, table: Path, maps: Path | None) -> None:
        self.table, self._maps_path = table, maps
        self._file: TextIO | None = open(table, "w", newline="", encoding="utf-8")
        self._writer = csv.writer(self._file, lineterminator="\n")
        self._writer.writerow(COLUMNS)
        self._container: Any = None
        self._stream: Any = None
        self._factor = float(np.log(find_factor(1.0, _LEVEL)))
        self.has_maps = False

    def add(self, reading: Reading, pulse: PulseEstimate | None) -> None:
        """Add a reading, and the last estimate of the pulse."""
        self._writer.writerow(self._make_row(reading, pulse))
        if self._maps_path is not None and reading.texture is not None:
            self._add_map(reading)

    def close(self) -> None:
        """Finish both files.

        Raises:
            OSError: There is no space.
        """
        file, self._file = self._file, None
        container, self._container = self._container, None
        try:
            if file is not None:
                file.close()
        finally:
            if container is not None:
                for packet in self._stream.encode():
                    container.mux(packet)
                container.close()

    def discard(self) -> None:
        """Close what is open, whatever has happened."""
        file, self._file = self._file, None
        container, self._container = self._container, None
        for each in (file, container):
            if each is not None:
                with suppress(OSError, ValueError):
                    each.close()

    def rescue(self) -> None:
        """Give up the video of the map, so that there is space for the table, and close it."""
        container, self._container = self._container, None
        if container is not None:
            with suppress(OSError, ValueError):
                container.close()
        if self._maps_path is not None:
            with suppress(OSError):
                self._maps_path.unlink(missing_ok=True)
        self._maps_path, self.has_maps = None, False
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
            self._file = None
        _cut_last_row(self.table)

    def _make_row(self, reading: Reading, pulse: PulseEstimate | None) -> list[str]:
        cells = [
            str(reading.number),
            f"{reading.time:.6f}",
            str(reading.shot),
            reading.state,
            _round(reading.gain[0]),
        ]
        factor = np.exp(self._factor * reading.log_sd)
        for index in range(len(NAMES)):
            blood = reading.hemoglobin[index]
            cells += [
                _round(blood),
                _round(blood / factor[index]),
                _round(blood * factor[index]),
                _round(reading.change[index]),
                _round(reading.change_sd[index]),
            ]
        return cells + _describe_pulse(pulse)

    def _add_map(self, reading: Reading) -> None:
        assert self._maps_path is not None
        pixels = draw_map_frame(reading)
        av = _import_av()
        if self._container is None:
            # The temporary name ends as the file does; the format is said all the same.
            self._container = av.open(str(self._maps_path), "w", format="mp4")
            self._stream = _add_stream(av, self._container, pixels.shape)
            self.has_maps = True
        frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
        frame.pts, frame.time_base = round(reading.time * _TICKS), Fraction(1, _TICKS)
        for packet in self._stream.encode(frame):
            self._container.mux(packet)


def _describe_pulse(pulse: PulseEstimate | None) -> list[str]:
    """Cells of the pulse; without its rate if that cannot be read."""
    if pulse is None:
        return ["", ""]
    rate = _round(pulse.rate) if pulse.quality >= LEAST_QUALITY else ""
    return [rate, _round(pulse.quality)]


def _add_stream(av: Any, container: Any, shape: tuple[int, ...]) -> Any:
    codecs = ("libx264", "mpeg4")
    name = next(each for each in codecs if each in av.codec.codecs_available)
    stream = container.add_stream(name, rate=30)
    stream.height, stream.width = shape[:2]
    stream.pix_fmt = "yuv420p"
    stream.codec_context.time_base = Fraction(1, _TICKS)
    if name == "libx264":
        stream.options = {"crf": "23", "preset": "ultrafast"}
    return stream


def write_summary(
    path: Path, panel: Path, table: Path, track: Track, about: dict[str, Any]
) -> dict[str, Any]:
    """Write the panel, and the summary with all rows of the table. Returns the summary."""
    summary = about | track.to_dict()
    text = json.dumps(summary, indent=2, allow_nan=False)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.removesuffix("\n}") + ',\n  "series": [')
        for number, row in enumerate(_read_rows(table)):
            file.write((",\n    " if number else "\n    ") + json.dumps(row))
        file.write("\n  ]\n}\n")
    write_png(panel, track.draw(), Mark("track", "panel", about["input"]["sha256"]).to_text())
    return summary


def _read_rows(table: Path) -> Iterator[dict[str, Any]]:
    """Rows of the table as records: numbers, and regions as records in them."""
    with open(table, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            regions = {
                name: {field: _number(row[f"{name}_{field}"]) for field in _FIELDS}
                for name in NAMES
            }
            yield {
                "frame": int(row["frame"]),
                "time": float(row["time"]),
                "shot": int(row["shot"]),
                "state": row["state"],
                "gain": _number(row["gain"]),
                "regions": regions,
                "pulse_bpm": _number(row["pulse_bpm"]),
                "pulse_quality": _number(row["pulse_quality"]),
            }


def _cut_last_row(table: Path) -> None:
    """Cut a row that is half-written."""
    with suppress(OSError), open(table, "rb+") as file:
        content_end = file.seek(0, 2)
        start = max(0, content_end - 65536)
        file.seek(start)
        tail = file.read()
        file.truncate(start + tail.rfind(b"\n") + 1)


def _round(value: float) -> str:
    return f"{value:.6g}" if np.isfinite(value) else ""


def _number(cell: str) -> float | None:
    return float(cell) if cell else None


def is_full(error: OSError) -> bool:
    """Whether a disk is full, or a quota used up."""
    return error.errno in (errno.ENOSPC, errno.EDQUOT)


def describe_full(folder: Path, error: OSError) -> InputError:
    """Make the error for results that could only be written in part."""
    return InputError(
        f"Results could not be written to {folder} to their end {_explain_fault(error)}. The table "
        "holds what was read so far."
    )
