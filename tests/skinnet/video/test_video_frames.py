"""Frames of files: time stamps, rotation, and folders."""

import struct
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from skinnet.errors import InputError
from skinnet.video._folder_frames import FolderFrames
from skinnet.video._video_frames import VideoFrames
from tests.small_videos import write_video

TIMES = (0.0, 0.04, 0.25, 0.30, 0.9)


def make_pictures(count: int) -> list[np.ndarray]:
    pictures = [np.zeros((64, 96, 3), np.uint8) for _ in range(count)]
    for number, picture in enumerate(pictures):
        picture[:32, :48] = 40 * (number + 1)
    return pictures


def test_uneven_time_stamps_are_kept(tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    with av.open(str(tmp_path / "uneven.mkv"), "w") as container:
        stream = container.add_stream("ffv1", rate=30)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "bgr0"
        stream.codec_context.time_base = Fraction(1, 1000)
        for time, picture in zip(TIMES, make_pictures(5), strict=True):
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24").reformat(format="bgr0")
            frame.pts, frame.time_base = round(1000 * time), Fraction(1, 1000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    frames = list(VideoFrames(tmp_path / "uneven.mkv", "uneven.mkv"))
    assert np.allclose([frame.time for frame in frames], TIMES, atol=2e-3)
    assert (frames[3].pixels == make_pictures(5)[3]).all()


def test_the_rotation_of_a_phone_is_applied(tmp_path: Path) -> None:
    video = write_video(tmp_path / "phone.mp4", make_pictures(5))
    content = bytearray(video.read_bytes())
    start = content.index(b"tkhd") + 44  # the display matrix of a version 0 header
    clockwise = (0, 1 << 16, 0, -(1 << 16), 0, 0, 64 << 16, 0, 1 << 30)
    content[start : start + 36] = struct.pack(">9i", *clockwise)
    video.write_bytes(content)
    last = list(VideoFrames(video, "phone.mp4"))[-1].pixels
    assert last.shape == (96, 64, 3)
    assert last[10, 50].min() > 150 > 50 > last[10, 10].max()


def test_a_file_that_is_cut_off_gives_what_it_has(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (40, 64, 64, 3)).astype(np.uint8)
    whole = write_video(tmp_path / "whole.mkv", list(noise))
    content = whole.read_bytes()
    (tmp_path / "half.mkv").write_bytes(content[: len(content) // 2])
    frames = list(VideoFrames(tmp_path / "half.mkv", "half.mkv"))
    assert 5 < len(frames) < 40


def test_a_video_without_time_stamps_asks_for_the_rate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    video = write_video(tmp_path / "plain.mp4", make_pictures(4))

    class Timeless:
        time = None

        def __init__(self, frame: Any) -> None:
            self.to_ndarray = frame.to_ndarray

    decode = VideoFrames._decode
    monkeypatch.setattr(VideoFrames, "_decode", lambda self: map(Timeless, decode(self)))
    with pytest.raises(InputError, match=r"no time stamps.*--fps"):
        list(VideoFrames(video, "plain.mp4"))
    times = [frame.time for frame in VideoFrames(video, "plain.mp4", 10.0)]
    assert np.allclose(times, [0, 0.1, 0.2, 0.3])


def test_a_folder_has_its_times_in_a_table(tmp_path: Path) -> None:
    for number, picture in enumerate(make_pictures(3)):
        Image.fromarray(picture).save(tmp_path / f"{number}.png")
    (tmp_path / "times.csv").write_text("file,time\n2.png,5.5\n0.png,5.0\n1.png,5.2\n")
    frames = FolderFrames(tmp_path, "folder")
    read = list(frames)
    assert np.allclose([frame.time for frame in read], [0, 0.2, 0.5])
    assert frames.duration == pytest.approx(0.5) and read[2].pixels[0, 0, 0] == 120
    (tmp_path / "times.csv").write_text("file,time\n2.png,soon\n")
    with pytest.raises(InputError, match="line 2"):
        FolderFrames(tmp_path, "folder")
