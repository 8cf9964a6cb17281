"""Frames of video files and cameras, upright, with their time stamps."""

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_fault, _explain_missing

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
        self._bits = self._pixels = 0

    def __iter__(self) -> Iterator[Frame]:
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
        if dropped:
            self.notes.append(
                f"{dropped} frames of {self.name} whose time stamps go back were left out."
            )

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
        """Decode all frames; a few damaged packets are passed over, and said."""
        bad = 0
        packets = self._container.demux(self._stream)
        while True:
            try:
                packet = next(packets)
                self._bits += 8 * packet.size
                yield from packet.decode()
                bad = 0
            except StopIteration:
                break
            except (OSError, ValueError) as error:
                bad += 1
                if bad == 1:
                    self.notes.append(f"{self.name} is damaged in places ({_shorten(error)}).")
                if bad >= _MOST_BAD:
                    raise BrokenVideoError(
                        f"{self.name} is broken: {bad} parts one after the other cannot be decoded "
                        f"({_shorten(error)}). What came before is read."
                    ) from error

    def _find_time(self, frame: Any, number: int) -> float:
        if frame.time is not None:
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
