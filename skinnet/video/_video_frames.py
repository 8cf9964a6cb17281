"""Frames of video files and cameras, upright, with their time stamps."""

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_fault, _explain_missing

_SEQUENTIAL, _MOST_REST = ("mpegts",), 0.9
"""Formats without an index, and the part of such a file that is read at least if it is whole."""

_LEAST_BITS = 0.05
"""Bits a pixel below which compression is strong enough to be said."""

_MOST_BAD = 30
"""Damaged packets one after the other after which a stream counts as broken."""


class Frame(NamedTuple):
    """A frame.

    Attributes:
        time: Seconds from the first frame.
        pixels: uint8 sRGB, [H, W, 3], upright.
    """

    time: float
    pixels: NDArray[np.uint8]


class BrokenVideoError(InputError):
    """A video that cannot be read to its end; what came before is good."""


class VideoFrames:
    """Reads a video one frame at a time.

    Args:
        path: The file; or the number of a camera.
        name: What messages call it.
        rate: Frames a second, where there are no time stamps; None to refuse such.

    Attributes:
        duration: Its length in seconds, as it states; None if it does not.
        notes: Sentences that the user should read.
        bits_per_pixel: Bits that the file spends on a pixel of a frame that was read; None before.
    """

    def __init__(self, path: Path | int, name: str, rate: float | None = None) -> None:
        self.name, self._rate = name, rate
        self._av = _import_av()
        self._container = self._open(path)
        self.notes: list[str] = []
        if not self._container.streams.video:
            raise InputError(f"{name} has no picture, only sound or data; give a video.")
        self._stream = self._container.streams.video[0]
        self._stream.thread_type = "AUTO"
        self.duration = self._find_duration()
        self.bits_per_pixel: float | None = None
        self._bits = self._pixels = self._damaged = 0
        self._left: str | None = None
        self._is_rate_ignored = False

    def __iter__(self) -> Iterator[Frame]:
        """Frames in order of time.

        Raises:
            BrokenVideoError: At the end, if it is damaged or breaks off.
        """
        first, last, number, dropped = None, -math.inf, 0, 0
        with self._container:
            for frame in self._decode():
                time = self._find_time(frame, number)
                number += 1
                first = time if first is None else first
                if time - first <= last:
                    dropped += 1
                    continue
                last = time - first
                yield Frame(last, self._convert(frame))
        if 2 * dropped >= number > 1:
            raise BrokenVideoError(
                f"{dropped} of the {number} frames of {self.name} have time stamps that do not "
                "increase; make it anew with a program that writes time stamps."
            )
        if dropped:
            self.notes.append(
                f"{dropped} frames of {self.name} whose time stamps go back were left out."
            )
        if self._is_rate_ignored:
            self.notes.append(
                f"{self.name} has time stamps, which are taken instead of --fps {self._rate:g}."
            )
        self._check_end(last)

    def _check_end(self, last: float) -> None:
        """Check that nothing was left out by damage, and that the stream goes to its end."""
        if self._left is not None:
            raise BrokenVideoError(
                f"{self.name} breaks off at {max(last, 0):.2f} s{self._left}; record or copy it "
                "again. What came before is read."
            )
        if self._damaged:
            raise BrokenVideoError(
                f"{self.name} is damaged: {self._damaged} of its frames cannot be decoded rightly "
                "and were left out. The others are read."
            )

    def _find_left(self, end: float, position: int) -> str | None:
        """Say what is missing after the last packet, at a time and a place in the file."""
        stated, slack = self.duration, 0.05 if self._stream.duration is not None else 0.1
        if stated is not None and stated - end > max(0.5 + slack, slack * stated):
            return f" of {stated:.2f} s"
        size = self._container.size
        if self._container.format.name in _SEQUENTIAL and position < _MOST_REST * size:
            return f", and {100 * (1 - position / size):.0f} % of the file cannot be read"
        return None

    def _open(self, path: Path | int) -> Any:
        if isinstance(path, int):
            return self._open_camera(path)
        try:
            return self._av.open(str(path))
        except (OSError, ValueError) as error:
            if isinstance(error, FileNotFoundError | PermissionError | IsADirectoryError):
                raise InputError(f"{path} cannot be read {_explain_fault(error)}.") from error
            raise InputError(
                f"{self.name} is no video that FFmpeg can read ({_shorten(error)}); give a file "
                "such as MP4, MOV, MKV or WebM."
            ) from error

    def _open_camera(self, number: int) -> Any:
        kind, device = _name_camera(number)
        if kind not in self._av.formats_available:
            raise InputError(
                f"Camera {number} cannot be opened: PyAV is built without {kind} here. Record "
                "a video with another program, and give its file; or feed frames to Tracker in "
                "Python."
            )
        try:
            return self._av.open(device, format=kind)
        except (OSError, ValueError) as error:
            raise InputError(
                f"Camera {number} ({device}) cannot be opened ({_shorten(error)}); is it plugged "
                "in, and not in use by another program?"
            ) from error

    def _find_duration(self) -> float | None:
        stream, container = self._stream, self._container
        if stream.duration is not None and stream.time_base is not None:
            return float(stream.duration * stream.time_base)
        return None if container.duration is None else container.duration / 1e6

    def _decode(self) -> Iterator[Any]:
        """Decode all frames but those that are damaged, or made from such.

        A frame is made from those before it, back to the last key frame.
        """
        bad, is_clean, seen = 0, True, False
        end, position, start = 0.0, 0, None
        packets = self._container.demux(self._stream)
        while True:
            try:
                packet = next(packets)
                self._bits += 8 * packet.size
                if packet.pts is not None and packet.size:
                    start = packet.pts if start is None else min(start, packet.pts)
                    length = packet.pts - start + (packet.duration or 0)
                    end = max(end, float(length * packet.time_base))
                    position = max(position, (packet.pos or 0) + packet.size)
                for frame in packet.decode():
                    bad, seen = 0, True
                    is_clean = (is_clean or frame.key_frame) and not frame.is_corrupt
                    self._damaged += not is_clean
                    if is_clean:
                        yield frame
            except StopIteration:
                break
            except (OSError, ValueError) as error:
                bad += 1
                self._damaged += seen  # a stream may begin between two key frames
                is_clean = not seen
                if bad >= _MOST_BAD:
                    raise BrokenVideoError(
                        f"{self.name} is broken: {bad} parts one after the other cannot be decoded "
                        f"({_shorten(error)}). What came before is read."
                    ) from error
        if seen:
            self._left = self._find_left(end, position)

    def _find_time(self, frame: Any, number: int) -> float:
        if frame.time is not None:
            self._is_rate_ignored = self._rate is not None
            return float(frame.time)
        if self._rate is None:
            raise InputError(
                f"{self.name} has no time stamps, without which no rate can be told; give --fps "
                "with its frames a second."
            )
        return number / self._rate

    def _convert(self, frame: Any) -> NDArray[np.uint8]:
        pixels = frame.to_ndarray(format="rgb24")
        self._pixels += pixels.shape[0] * pixels.shape[1]
        self.bits_per_pixel = self._bits / self._pixels
        turns = round(getattr(frame, "rotation", 0) / 90) % 4
        upright: NDArray[np.uint8] = np.ascontiguousarray(np.rot90(pixels, turns))
        return upright


def note_compression(name: str, bits: float | None) -> tuple[str, ...]:
    """Say that a video of so many bits a pixel is compressed strongly, if it is."""
    if bits is None or bits >= _LEAST_BITS:
        return ()
    return (
        f"{name} has only {bits:.3f} bits a pixel: such compression leaves wrong colours for "
        "seconds, and hides the pulse. Intervals are wider; record with less compression.",
    )


def _import_av() -> Any:
    try:
        import av
    except ImportError as error:
        raise _explain_missing(error, "video", "Reading a video") from error
    av.logging.set_level(None)
    return av


def _name_camera(number: int) -> tuple[str, str]:
    """FFmpeg's name of cameras on this system, and that of one of them."""
    if sys.platform == "darwin":
        return "avfoundation", str(number)
    if sys.platform == "win32":
        return "dshow", f"video={number}"
    return "v4l2", f"/dev/video{number}"


def _shorten(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or error).splitlines()[0][:120]
