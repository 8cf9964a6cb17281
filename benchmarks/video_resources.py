"""Speed and memory of the tracker."""

import gc
import resource
import sys
import time
from itertools import cycle
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from benchmarks.report import Results
from benchmarks.test_sets import log
from skinnet.images.resizing import resize
from skinnet.inference import Decomposer
from skinnet.inference._workers.worker_count import count_cores
from skinnet.video import Tracker
from skinnet.video._track_files import TrackFiles
from skinnet.video._video_frames import VideoFrames
from train.synthetic.faces import SyntheticFaces
from train.synthetic.videos.clip_files import ClipWriter
from train.synthetic.videos.clips import Clips

_HEIGHT, _WIDTH = 720, 1280
_BASELINE = (0.0, 0.5)
_LOOPED_RATE = 10.0
_LOOPED = 20


def measure_speed(
    clips: Clips, data: SyntheticFaces, decomposer: Decomposer, frames: int
) -> Results:
    """Measure frames a second at 720p, from the file to all results but the panel.

    The baseline, in which the network reads some frames, is counted apart: it has a fixed cost.
    """
    with TemporaryDirectory() as folder:
        video = Path(folder) / "clip.mp4"
        _write_large(clips, data, video, frames)
        files = TrackFiles(Path(folder) / "table.csv", Path(folder) / "map.mp4")
        tracker, count, begun = Tracker(decomposer, baseline=_BASELINE), 0, None
        started = cpu = 0.0
        opened = time.perf_counter()
        for frame in VideoFrames(video, "clip"):
            readings = tracker.add(frame.pixels, frame.time)
            for reading in readings:
                files.add(reading, None)
            if begun is None and readings:
                begun, started, cpu = frame.time, time.perf_counter(), time.process_time()
            elif begun is not None:
                count += 1
        spent, used = time.perf_counter() - started, time.process_time() - cpu
        files.close()
    return {
        "frames": count,
        "frames_per_second": count / spent if count else None,
        "frames_per_second_of_processor_time": count / used if count else None,
        "baseline_s": started - opened,
        "cores": count_cores(),
    }


def measure_memory(
    clips: Clips, data: SyntheticFaces, decomposer: Decomposer, minutes: int
) -> Results:
    """Measure by how much memory grows over some minutes of a looped clip, at ten frames a second.

    Time stamps go on, so that for the tracker it is one long video.
    """
    renderer = clips.make_renderer(data, clips.plan(0))
    pictures = [renderer.render(number / _LOOPED_RATE) for number in range(_LOOPED)]
    count = round(60 * minutes * _LOOPED_RATE)
    with TemporaryDirectory() as folder:
        files = TrackFiles(Path(folder) / "table.csv", Path(folder) / "map.mp4")
        tracker, early = Tracker(decomposer), 0.0
        for number, picture in zip(range(count), cycle(pictures), strict=False):
            for reading in tracker.add(picture, number / _LOOPED_RATE):
                files.add(reading, None)
            if number == count // 10:
                gc.collect()
                early = _measure_memory()
                log(f"\rMemory: {minutes} minutes of video.\n")
        gc.collect()
        late = _measure_memory()
        files.close()
    return {"minutes": minutes, "grown_mb": late - early, "peak_mb": _measure_peak()}


def _write_large(clips: Clips, data: SyntheticFaces, path: Path, frames: int) -> None:
    renderer, writer = clips.make_renderer(data, clips.plan(0)), ClipWriter(path, 20)
    pictures = [_place(renderer.render(number / 30)) for number in range(min(frames, 30))]
    for number, picture in zip(range(frames), cycle(pictures + pictures[::-1]), strict=False):
        writer.add(picture, number / 30)
    writer.close()


def _place(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """A picture of the face in a frame of 1280 x 720."""
    whole = np.full((_HEIGHT, _WIDTH, 3), 90, np.uint8)
    left = (_WIDTH - _HEIGHT) // 2
    whole[:, left : left + _HEIGHT] = resize(picture, _HEIGHT, _HEIGHT)
    return whole


def _measure_memory() -> float:
    """Resident memory now, in MB; the peak where the system does not tell it."""
    status = Path("/proc/self/statm")
    if not status.is_file():
        return _measure_peak()
    pages = int(status.read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 1e6


def _measure_peak() -> float:
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6
