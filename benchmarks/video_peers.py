"""Public networks that read a pulse from a face, where their files are at hand."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import onnxruntime
from numpy.typing import NDArray

from benchmarks.pulse_baselines import METHODS
from skinnet.errors import InputError
from skinnet.images import find_faces, resize
from skinnet.video._pulse import filter_band, find_peak
from skinnet.video._video_frames import Frame

_RATE, _FRAMES, _SIDE = 30.0, 128, 128
"""Frames a second, frames of a piece, and side of the face in pixels, where a file leaves open."""

_MARGIN = 1.5
"""Side of the face's square in sides of its box."""


class PulsePeer:
    """A network from a piece of a face video to its pulse wave.

    Its input is float32 RGB in [0, 1], [1, 3, frames, height, width], and its output has one number
    for each frame: the layout of PhysNet (Yu et al. 2019) and of networks made like it.

    Args:
        path: Its ONNX file.

    Raises:
        InputError: The file has another layout.
    """

    def __init__(self, path: Path) -> None:
        self.name = path.stem
        self._session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
        shape = self._session.get_inputs()[0].shape
        if len(shape) != 5 or shape[1] not in (3, "3"):
            raise InputError(
                f"{path} takes {shape}; a peer takes RGB as [1, 3, frames, height, width]."
            )
        usual = (_FRAMES, _SIDE, _SIDE)
        self._frames, self._height, self._width = (
            given if isinstance(given, int) else other
            for given, other in zip(shape[2:], usual, strict=True)
        )

    def __call__(self, frames: Sequence[Frame]) -> float | None:
        """Estimate the pulse of a clip, in beats per minute; None where it is too short."""
        cut = self._cut(frames)
        if cut is None or len(cut) < self._frames:
            return None
        name, waves = self._session.get_inputs()[0].name, []
        for start in range(0, len(cut) - self._frames + 1, self._frames):
            piece = np.moveaxis(cut[start : start + self._frames], -1, 0)[None]
            wave = np.asarray(self._session.run(None, {name: piece})[0], np.float64).ravel()
            waves.append((wave - wave.mean()) / max(float(wave.std()), 1e-9))
        return find_peak(filter_band(np.concatenate(waves)[:, None])[:, 0])[0]

    def _cut(self, frames: Sequence[Frame]) -> NDArray[np.float32] | None:
        """The face at 30 frames a second, in the place that it has in the first frame."""
        faces = find_faces(frames[0].pixels)
        if not faces:
            return None
        box = max((face.box for face in faces), key=lambda each: each.width)
        margin = round((_MARGIN - 1) / 2 * box.width)
        rows = slice(max(0, box.top - margin), box.bottom + margin)
        columns = slice(max(0, box.left - margin), box.right + margin)
        times = np.array([one.time for one in frames])
        even = np.arange(0, times[-1], 1 / _RATE)
        chosen = np.abs(times[:, None] - even).argmin(0)
        small = [resize(np.ascontiguousarray(frames[index].pixels[rows, columns]),
                        self._width, self._height) for index in chosen]  # fmt: skip
        return np.stack(small).astype(np.float32) / np.float32(255)


def list_peers(folder: Path | None) -> list[PulsePeer]:
    """List the networks of a folder.

    Raises:
        InputError: There is no such folder.
    """
    if folder is None:
        return []
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder; give that of public networks as .onnx files.")
    files = sorted(folder.glob("*.onnx"))
    taken = {*METHODS, "skinnet"}
    return [PulsePeer(path) for path in files if path.stem not in taken]
