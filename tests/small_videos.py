"""Short videos of the astronaut, whose hemoglobin rises."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from skimage.data import astronaut

RATE, COUNT = 20, 24


class Tracked(NamedTuple):
    """A video file, the folder of its results, and their summary."""

    video: Path
    folder: Path
    summary: dict[str, Any]


def make_frames(count: int = COUNT, rise: float = 0.15) -> list[np.ndarray]:
    """Crops of the astronaut with noise, whose green and blue fall in the second half."""
    photo, rng = astronaut()[:256, 100:356].astype(np.float32), np.random.default_rng(0)
    frames = []
    for number in range(count):
        share = max(0.0, 2 * number / count - 1)
        colours = np.array([1 - 0.1 * rise * share, 1 - rise * share, 1 - rise * share])
        frame = photo * colours + rng.normal(0, 1.5, photo.shape)
        frames.append(np.rint(frame.clip(0, 255)).astype(np.uint8))
    return frames


def write_video(path: Path, frames: list[np.ndarray], rate: float = RATE) -> Path:
    av = pytest.importorskip("av")
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=int(rate))
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt, stream.options = "yuv420p", {"crf": "12", "preset": "ultrafast"}
        for pixels in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(pixels, format="rgb24")))
        container.mux(stream.encode())
    return path
