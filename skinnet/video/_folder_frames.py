"""Frames of a folder of pictures, with their time stamps."""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from skinnet.errors import InputError, _explain_fault
from skinnet.images._walk import walk
from skinnet.images.photograph import read_picture
from skinnet.video._video_frames import Frame

TIMES = "times.csv"
"""Table of time stamps in a folder: the columns file and time, in seconds."""


class FolderFrames:
    """Reads the pictures of a folder in the order of their time stamps.

    Args:
        folder: The folder; its file times.csv has the columns file and time.
        name: What messages call it.
        rate: Frames a second, where there is no such file: pictures are then in the order of their
            names.

    Attributes:
        duration: Time from the first frame to the last one, in seconds.
        notes: Sentences that the user should read.
        bits_per_pixel: None: pictures are compressed apart, which holds no colours over time.
    """

    bits_per_pixel: float | None = None

    def __init__(self, folder: Path, name: str, rate: float | None = None) -> None:
        self.notes: list[str] = []
        self._frames = self._list(folder, name, rate)
        self.duration: float | None = (
            self._frames[-1][0] - self._frames[0][0] if self._frames else 0.0
        )

    def __iter__(self) -> Iterator[Frame]:
        for time, path in self._frames:
            yield Frame(time - self._frames[0][0], read_picture(path).srgb)

    def _list(self, folder: Path, name: str, rate: float | None) -> list[tuple[float, Path]]:
        if (folder / TIMES).is_file():
            return _read_times(folder)
        if rate is None:
            raise InputError(
                f"{name} is a folder without time stamps; put a file {TIMES} with the columns file "
                "and time (in seconds) into it, or give --fps with its frames a second."
            )
        found = walk([str(folder)], False)
        self.notes += found.notes
        pictures = (Path(each.path) for each in found.pictures)
        files = sorted(path for path in pictures if not path.is_dir())
        if not files:
            raise InputError(f"{name} has no pictures; give a folder with the frames of a video.")
        return [(number / rate, path) for number, path in enumerate(files)]


def _read_times(folder: Path) -> list[tuple[float, Path]]:
    path = folder / TIMES
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = _explain_fault(error) if isinstance(error, OSError) else f"({error})"
        raise InputError(f"{path} cannot be read {reason}.") from error
    frames = []
    for line, row in enumerate(rows, 2):
        try:
            time, file_name = float(row["time"]), row["file"]
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(
                f"{path}, line {line}, has no file and time in seconds; its first line is "
                "file,time."
            ) from error
        if not math.isfinite(time):
            raise InputError(f"{path}, line {line}, has the time {time}; give it in seconds.")
        frames.append((time, folder / file_name))
    return sorted(frames)
