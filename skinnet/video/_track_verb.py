"""The verb `track`, with options that are parsed."""

import argparse
import hashlib
import json
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from skinnet.errors import InputError
from skinnet.files import write_together
from skinnet.files._partial import write_aside
from skinnet.images._mark import read_mark
from skinnet.images._result_names import OUTPUT, choose_stem, compute_digest, lock_folder
from skinnet.images.faces._face_models import open_ahead
from skinnet.images.photograph import read_picture
from skinnet.inference._messages import note, print_line, report
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.results import _describe_fault, _make_folder
from skinnet.video._folder_frames import FolderFrames
from skinnet.video._frame_progress import FrameProgress
from skinnet.video._pulse import LEAST_QUALITY
from skinnet.video._still_image import StillImage
from skinnet.video._track_files import (
    ENDS,
    MAPS,
    PANEL,
    SUMMARY,
    TABLE,
    TrackFiles,
    describe_full,
    is_full,
    write_summary,
)
from skinnet.video._video_frames import (
    BrokenVideoError,
    Frame,
    VideoFrames,
    note_compression,
)
from skinnet.video.track import Track
from skinnet.video.tracker import Tracker

_CAMERA = "camera"
"""Name of the results of a camera."""

_STILL = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".heic", ".webp", ".bmp", ".avif", ".jp2")


@runtime_checkable
class _Frames(Protocol):
    """What frames are read from."""

    duration: float | None
    notes: list[str]
    bits_per_pixel: float | None

    def __iter__(self) -> Iterator[Frame]: ...


def track(options: argparse.Namespace) -> bool:
    """Track the face of a video, and write its results. Returns whether all of it could be read."""
    _check(options)
    open_ahead()
    decomposer = Decomposer(options.model, providers=options.provider)
    decomposer.load()
    told = ToldCapture.from_options(options, decomposer, 1)
    name = _CAMERA if options.device is not None else Path(options.input).resolve().name
    frames = _open(options, name)
    run = _Run(options, name, decomposer, told)
    return run.run(frames)


def _check(options: argparse.Namespace) -> None:
    """Check the options; a number as --camera is a device, and a name is what sensor it has."""
    is_device = options.camera is not None and options.camera.isdecimal()
    options.device = int(options.camera) if is_device else None
    options.camera = None if is_device else options.camera
    if (options.input is None) == (options.device is None):
        raise InputError(
            "track needs one video, a folder of frames with time stamps, or --camera with its "
            "number."
        )
    for name, value in (("--fps", options.fps), ("--seconds", options.seconds)):
        if value is not None and not 0 < value < 1e7:
            raise InputError(f"{name} is a number above 0; got {value:g}.")


def _open(options: argparse.Namespace, name: str) -> _Frames:
    if options.device is not None:
        return VideoFrames(options.device, f"Camera {options.device}", options.fps)
    path = Path(options.input)
    if path.is_dir():
        return FolderFrames(path, name, options.fps)
    if path.suffix.lower() in _STILL:
        raise InputError(
            f"{name} is a photograph, in which nothing changes over time; skinnet predict reads it."
        )
    return VideoFrames(path, name, options.fps)


class _Run:
    """One run over a video."""

    def __init__(
        self, options: argparse.Namespace, name: str, decomposer: Decomposer, told: ToldCapture
    ) -> None:
        self.options, self.name, self.decomposer, self.told = options, name, decomposer, told
        self.notes: list[str] = []
        self.fault: BaseException | None = None
        self.has_read = False

    def run(self, frames: _Frames) -> bool:
        """Read all frames, and write what was read, whatever ends it."""
        path = None if self.options.device is not None else Path(self.options.input)
        beside = Path() if path is None else path.parent
        folder = _make_folder(self.options.output or beside / OUTPUT)
        digest = _compute_digest(path)
        with lock_folder(folder):
            stem = choose_stem(
                folder,
                f"{Path(self.name).stem}_track",
                ENDS,
                lambda file: _is_own(file, digest),
            )
            summary = self._write(frames, folder, stem, digest)
        for sentence in summary["notes"]:
            note(sentence)
        self._print(summary, folder / stem)
        if isinstance(self.fault, KeyboardInterrupt):
            note("Ctrl-C has ended it; what was read before is kept.")
            raise self.fault
        if isinstance(self.fault, Exception):
            report(self.fault)
        return self.fault is None

    def _write(self, frames: _Frames, folder: Path, stem: str, digest: str) -> dict[str, Any]:
        with ExitStack() as stack:
            try:
                temporary = stack.enter_context(write_together())
                table = temporary(folder / f"{stem}{TABLE}")
                aside = stack.enter_context(write_aside(folder))
                maps = aside(MAPS) if self.options.map else None
                files = TrackFiles(table, maps)
                stack.callback(files.discard)
                found = self._follow(frames, files)
                self._close(files, folder)
                doubts = note_compression(self.name, frames.bits_per_pixel)
                told = (*found.notes, *doubts, *frames.notes, *self.notes)
                found = replace(found, notes=tuple(dict.fromkeys(told)))
                bits = frames.bits_per_pixel and round(frames.bits_per_pixel, 4)
                about = {"file": self.name, "input": {"sha256": digest, "bits_per_pixel": bits}}
                summary = self._save(folder / stem, table, maps, found, about)
            except OSError as error:
                raise _describe_fault(folder, error) from error
        return summary

    def _save(
        self, stem: Path, table: Path, maps: Path | None, found: Track, about: dict[str, Any]
    ) -> dict[str, Any]:
        """Write what is beside the table; on a disk that is full, at least a short summary."""
        names = [stem.with_name(stem.name + end) for end in (SUMMARY, PANEL, MAPS)]
        try:
            with write_together() as temporary:
                summary = write_summary(
                    temporary(names[0]),
                    temporary(names[1]),
                    table,
                    found,
                    about | {"complete": not self.fault},
                )
                if maps is not None and maps.is_file():
                    maps.replace(temporary(names[2]))
            return summary
        except OSError as error:
            if not is_full(error):
                raise
            self.fault = describe_full(stem.parent, error)
        if maps is not None:
            maps.unlink(missing_ok=True)
        summary = about | {"complete": False} | found.to_dict()
        try:
            with write_together() as temporary:
                temporary(names[0]).write_text(json.dumps(summary, indent=2), "utf-8")
        except OSError as error:
            if not is_full(error):
                raise
        return summary

    def _follow(self, frames: _Frames, files: TrackFiles) -> Track:
        """Feed a tracker with the frames, until they end or something else ends it."""
        tracker: Tracker | None = None
        still = StillImage()
        progress = FrameProgress(self.options.seconds or frames.duration, self.options.json)
        try:
            with progress:
                for frame in frames:
                    if self.options.seconds is not None and frame.time > self.options.seconds:
                        break
                    tracker = tracker or self._make_tracker(frame)
                    still.add(frame)
                    for reading in tracker.add(frame.pixels, frame.time):
                        files.add(reading, tracker.pulse)
                        self.has_read = True
                    progress.advance(frame.time)
        except (InputError, KeyboardInterrupt) as error:
            if tracker is None or (isinstance(error, InputError) and not self._can_end(error)):
                raise
            self.fault = error
        except OSError as error:
            if not is_full(error) or tracker is None:
                raise
            self.fault = describe_full(files.table.parent, error)
            files.rescue()
            return self._finish(tracker, None, still)
        return self._finish(tracker, files, still)

    def _can_end(self, error: InputError) -> bool:
        """Whether there is something to keep although the video could not be read to its end."""
        return self.has_read or isinstance(error, BrokenVideoError)

    def _finish(
        self, tracker: Tracker | None, files: TrackFiles | None, still: StillImage
    ) -> Track:
        if tracker is None:
            raise self.fault or InputError(f"{self.name} has no frames that can be read.")
        if still.is_still and self.fault is None:
            raise InputError(
                f"All frames of {self.name} are the same but for compression: it is a still image, "
                "in which nothing changes over time; skinnet predict reads a photograph."
            )
        found = tracker.finish()
        if files is not None:
            for reading in tracker.waiting:
                files.add(reading, tracker.pulse)
        return found

    def _make_tracker(self, frame: Frame) -> Tracker:
        known, notes = self.told.tell(read_picture(frame.pixels, self.name))
        self.notes += notes
        begin, end = self.options.baseline
        return Tracker(
            self.decomposer,
            face=self.options.face,
            baseline=(begin, end),
            capture=known,
            maps=self.options.map or not self.options.json,
        )

    def _close(self, files: TrackFiles, folder: Path) -> None:
        try:
            files.close()
        except OSError as error:
            if not is_full(error):
                raise
            self.fault = describe_full(folder, error)
            files.rescue()

    def _print(self, summary: dict[str, Any], stem: Path) -> None:
        if self.options.json:
            print_line(json.dumps(summary, allow_nan=False))
            return
        pulse, melanin = summary["pulse"], summary["melanin"]["face"]["mean"]
        rate = "no pulse could be read"
        if pulse["quality"] is not None:
            what = f"pulse {pulse['rate_bpm']:.0f} per minute" if pulse["is_readable"] else rate
            unlike = not pulse["is_readable"] and pulse["quality"] >= LEAST_QUALITY
            why = ", but the face alone has another rhythm" if unlike else ""
            rate = f"{what} (quality {pulse['quality']:.2f}{why})"
        events = [each for each in summary["events"] if each["region"] == "face"]
        told = ", ".join(
            f"{each['kind']} at {each['onset']:.1f} s ({100 * (each['factor'] - 1):+.0f} %)"
            for each in events
        )
        ends = [end for end in ENDS if stem.with_name(stem.name + end).is_file()]
        files = f"{stem}{', '.join(ends[:-1])}{' and ' if ends[1:] else ''}{ends[-1]}"
        print_line(
            f"{self.name}: {summary['seconds']:.1f} s, melanin {100 * melanin:.2g} %, {rate}, "
            f"{told or 'no flush or blanching'}; files: {files}"
        )


def _compute_digest(path: Path | None) -> str:
    if path is None or not (path.is_dir() or path.is_file()):
        return ""  # a pipe cannot be read twice
    if not path.is_dir():
        return compute_digest(path)
    names = sorted(each.name for each in path.iterdir())
    return hashlib.sha256("\n".join([str(path.absolute()), *names]).encode()).hexdigest()


def _is_own(file: Path, digest: str) -> bool:
    """Whether a file is an earlier result of the same video."""
    if file.is_dir():
        return True  # it is not replaced; writing says that it is in the way
    mark = read_mark(file.with_suffix(PANEL))
    return mark is not None and mark.verb == "track" and mark.digest == digest
