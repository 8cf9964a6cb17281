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
from skinnet.video._video_frames import BrokenVideoError, Frame, VideoFrames, note_compression
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


def write_noise(path: Path, container_format: str, **options: str) -> bytes:
    """Two seconds of noise in small groups of pictures."""
    av, rng = pytest.importorskip("av"), np.random.default_rng(0)
    with av.open(str(path), "w", format=container_format, options=options) as container:
        stream = container.add_stream("libx264", rate=20)
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        stream.options = {"g": "8", "bf": "0"}
        for _ in range(40):
            pixels = rng.integers(0, 256, (64, 96, 3), np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(pixels, format="rgb24")))
        container.mux(stream.encode())
    return path.read_bytes()


def read_broken(path: Path) -> tuple[list[Frame], str]:
    """The frames that can be read, and the sentence that is said then."""
    frames: list[Frame] = []
    try:
        frames.extend(frame for frame in VideoFrames(path, path.name))
    except BrokenVideoError as error:
        return frames, str(error)
    return frames, ""


@pytest.mark.parametrize(
    ("kind", "options"),
    [("mp4", {"movflags": "faststart"}), ("matroska", {}), ("mpegts", {})],
    ids=["mp4", "mkv", "ts"],
)
def test_a_file_that_breaks_off_is_said_after_what_is_there(
    tmp_path: Path, kind: str, options: dict
) -> None:
    content = write_noise(tmp_path / "whole", kind, **options)
    assert len(list(VideoFrames(tmp_path / "whole", "whole"))) == 40
    half = len(content) // 2
    rest = bytes(len(content) - half) if kind == "mpegts" else b""
    (tmp_path / "cut").write_bytes(content[:half] + rest)
    frames, sentence = read_broken(tmp_path / "cut")
    assert 10 < len(frames) < 30 and "breaks off" in sentence


def test_damaged_frames_are_left_out_until_the_next_key_frame(tmp_path: Path) -> None:
    content = bytearray(write_noise(tmp_path / "whole", "mp4"))
    whole = list(VideoFrames(tmp_path / "whole", "whole"))
    middle = len(content) // 2
    content[middle : middle + 60] = bytes(range(60))
    (tmp_path / "damaged").write_bytes(content)
    frames, sentence = read_broken(tmp_path / "damaged")
    assert 30 <= len(frames) < 40 and "damaged" in sentence
    for frame in frames:
        same = next(each for each in whole if abs(each.time - frame.time) < 1e-6)
        assert (same.pixels == frame.pixels).all()


def test_bits_are_counted_and_strong_compression_is_said(tmp_path: Path) -> None:
    size = 8 * len(write_noise(tmp_path / "noise", "mp4"))
    video = VideoFrames(tmp_path / "noise", "noise")
    assert len(list(video)) == 40 and 0.8 * size < video.bits_per_pixel * 40 * 96 * 64 < size
    assert not note_compression("noise", video.bits_per_pixel) and not note_compression("a", None)
    assert "0.020 bits" in note_compression("clip.mp4", 0.02)[0]


def test_time_stamps_that_do_not_increase_are_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    video = write_video(tmp_path / "plain.mp4", make_pictures(4))
    monkeypatch.setattr(VideoFrames, "_find_time", lambda *_: 1.0)
    frames, sentence = read_broken(video)
    assert len(frames) == 1 and "3 of the 4 frames" in sentence and "do not increase" in sentence
