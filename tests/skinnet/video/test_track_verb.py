"""The verb `track`: its files, and its sentences for bad input."""

import csv
import errno
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from skinnet.cli import main
from skinnet.video import _track_verb
from skinnet.video._regions import NAMES
from skinnet.video._track_files import COLUMNS, TrackFiles
from tests.small_videos import COUNT, RATE, Tracked, make_frames, write_video


def test_all_files_are_written(tracked: Tracked) -> None:
    names = sorted(path.name for path in tracked.folder.iterdir())
    assert names == [f"clip_track{end}" for end in (".csv", ".json", ".mp4", ".png")]


def test_the_table_has_a_row_for_each_frame(tracked: Tracked) -> None:
    with open(tracked.folder / "clip_track.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(COLUMNS) and len(rows) == COUNT
    times = np.array([float(row["time"]) for row in rows])
    assert np.allclose(np.diff(times), 1 / RATE, atol=1e-3)
    assert float(rows[-1]["face_log_ratio"]) > 5 * abs(float(rows[3]["face_log_ratio"]))


def test_the_summary_has_the_same_series(tracked: Tracked) -> None:
    summary = tracked.summary
    assert summary["complete"] and len(summary["series"]) == COUNT
    assert set(summary["series"][-1]["regions"]) == set(NAMES) == set(summary["melanin"])
    last = summary["series"][-1]["regions"]["face"]
    assert last["hemoglobin_low"] < last["hemoglobin"] < last["hemoglobin_high"]
    assert "no medical device" in summary["disclaimer"]


def test_the_panel_carries_a_mark(tracked: Tracked) -> None:
    with Image.open(tracked.folder / "clip_track.png") as panel:
        assert panel.text["skinnet"].split()[2] == "track"


def test_a_second_run_replaces_its_own_results(tracked: Tracked) -> None:
    arguments = ["track", str(tracked.video), "-o", str(tracked.folder), "-q", "--seconds", "0.5"]
    assert main([*arguments, "--baseline", "0,0.2", "--no-map"]) == 0
    assert not list(tracked.folder.glob("*-2*"))


def refuse(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["track", *arguments]) == 2
    return capsys.readouterr().err.strip()


def test_bad_inputs_are_sentences(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "needs one video" in refuse(capsys)
    assert "photograph" in refuse(capsys, "photo.jpg")
    assert "cannot be read" in refuse(capsys, str(tmp_path / "absent.mp4"))
    (tmp_path / "text.mp4").write_text("no video")
    assert "no video that FFmpeg can read" in refuse(capsys, str(tmp_path / "text.mp4"))
    (tmp_path / "frames").mkdir()
    assert "--fps" in refuse(capsys, str(tmp_path / "frames"))
    assert "no pictures" in refuse(capsys, str(tmp_path / "frames"), "--fps", "20")
    assert "first and last second" in refuse(capsys, "a.mp4", "--baseline", "3")
    assert "above 0" in refuse(capsys, "a.mp4", "--fps", "0")


def test_a_camera_that_is_not_there_is_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert "Camera 97" in refuse(capsys, "--camera", "97")


def test_a_video_without_a_face_is_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    noise = np.random.default_rng(0).integers(90, 110, (6, 96, 96, 3)).astype(np.uint8)
    video = write_video(tmp_path / "wall.mp4", list(noise))
    assert "No face was found" in refuse(capsys, str(video))
    assert not list((tmp_path / "skinmaps").iterdir())


def test_a_still_image_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number in range(3):
        Image.fromarray(astronaut()).save(tmp_path / f"{number}.png")
    assert "still image" in refuse(capsys, str(tmp_path), "--fps", "5", "--baseline", "0,0.3")


def test_several_faces_are_asked_about(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pair = np.concatenate([make_frames(1)[0]] * 2, 1)
    video = write_video(tmp_path / "pair.mp4", [pair, pair[::-1]])
    said = refuse(capsys, str(video))
    assert "2 faces" in said and "--face" in said


def test_a_video_that_breaks_off_keeps_what_was_read(
    tracked: Tracked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = make_frames(10)

    class Broken:
        duration, notes, bits_per_pixel = None, (), None

        def __iter__(self):
            for number, pixels in enumerate(frames):
                yield _track_verb.Frame(number / RATE, pixels)
            raise _track_verb.BrokenVideoError("clip.mp4 is broken.")

    monkeypatch.setattr(_track_verb, "_open", lambda options, name: Broken())
    arguments = ["track", str(tracked.video), "-o", str(tmp_path), "--baseline", "0,0.2"]
    assert main([*arguments, "--no-map", "-q"]) == 2
    assert len((tmp_path / "clip_track.csv").read_text().splitlines()) == 11
    assert '"complete": false' in (tmp_path / "clip_track.json").read_text()


def test_a_full_disk_keeps_the_table(
    tracked: Tracked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    add, count = TrackFiles.add, [0]

    def fill(self, reading, pulse):
        count[0] += 1
        if count[0] > 8:
            raise OSError(errno.ENOSPC, "No space left on device")
        add(self, reading, pulse)

    monkeypatch.setattr(TrackFiles, "add", fill)
    said = refuse(
        capsys, str(tracked.video), "-o", str(tmp_path), "--baseline", "0,0.2", "--seconds", "0.6"
    )
    assert "No space left" in said and "read so far" in said
    assert len((tmp_path / "clip_track.csv").read_text().splitlines()) == 9
    assert not list(tmp_path.glob("*.mp4")) and not list(tmp_path.glob(".skinnet*"))


def test_a_disk_that_fills_at_the_end_keeps_the_table_and_a_short_summary(
    tracked: Tracked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    def fill(*arguments):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(_track_verb, "write_summary", fill)
    arguments = [str(tracked.video), "-o", str(tmp_path), "--baseline", "0,0.2", "--seconds", "0.6"]
    assert "No space left" in refuse(capsys, *arguments)
    assert len((tmp_path / "clip_track.csv").read_text().splitlines()) == 14
    assert json.loads((tmp_path / "clip_track.json").read_text())["complete"] is False
    assert sorted(each.suffix for each in tmp_path.iterdir()) == [".csv", ".json"]


def test_a_still_image_that_is_compressed_is_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    video = write_video(tmp_path / "still.mp4", make_frames(1) * 24)
    assert "still image" in refuse(capsys, str(video), "--baseline", "0,0.3")
    assert not list((tmp_path / "skinmaps").iterdir())


@pytest.mark.parametrize("word", ["--help", "-h"])
def test_help_names_the_device(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["track", word]) == 0
    assert "no medical device" in capsys.readouterr().out
