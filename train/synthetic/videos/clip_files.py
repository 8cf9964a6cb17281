"""Clips as video files with their truth beside them."""

import csv
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from skinnet.video._regions import NAMES
from train.synthetic.videos.clip_renderer import ClipRenderer

_BLOCK = 16
"""Side of a block of H.264 in pixels."""

Pixels = UInt8[np.ndarray, "height width 3"]


class ClipWriter:
    """Writes frames as H.264.

    Args:
        path: The video file.
        quality: Constant rate factor of H.264: 18 is nearly without visible loss, 28 poor.
        rate: Ticks of time stamps in a second.
    """

    def __init__(self, path: Path, quality: int = 18, rate: int = 1000) -> None:
        import av

        self._av, self._rate = av, rate
        self._container = av.open(str(path), "w")
        self._quality = quality
        self._stream: Any = None

    def add(self, pixels: Pixels, time: float) -> None:
        """Add a frame at a time in seconds."""
        if self._stream is None:
            self._stream = self._container.add_stream("libx264", rate=30)
            self._stream.height, self._stream.width = pixels.shape[:2]
            self._stream.pix_fmt = "yuv420p"
            self._stream.options = _choose_options(self._quality, pixels.shape)
            self._stream.codec_context.time_base = Fraction(1, self._rate)
        frame = self._av.VideoFrame.from_ndarray(pixels, format="rgb24")
        frame.pts, frame.time_base = round(time * self._rate), Fraction(1, self._rate)
        for packet in self._stream.encode(frame):
            self._container.mux(packet)

    def close(self) -> None:
        """Write what is left."""
        if self._stream is not None:
            for packet in self._stream.encode():
                self._container.mux(packet)
        self._container.close()


def _choose_options(quality: int, shape: tuple[int, ...]) -> dict[str, str]:
    """Options of x264 with which the same frames give the same file."""
    options = {"crf": str(quality), "preset": "veryfast"}
    if any(side % _BLOCK for side in shape[:2]):
        # The vector code of x264 reads memory beyond the edge of such frames.
        options["x264-params"] = "asm=0"
    return options


def write_clip(path: Path, renderer: ClipRenderer, quality: int = 18) -> None:
    """Write a clip, and its truth as NAME.csv: log ratio of hemoglobin to the face at rest.

    Args:
        path: The video file, such as clip.mp4.
        renderer: The clip.
        quality: Constant rate factor of H.264.
    """
    writer = ClipWriter(path, quality)
    with open(path.with_suffix(".csv"), "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["time", *NAMES])
        for frame in renderer:
            writer.add(frame.pixels, frame.time)
            table.writerow([f"{frame.time:.4f}", *(f"{one:.6f}" for one in frame.change)])
    writer.close()
