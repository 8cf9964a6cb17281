"""A short video of the astronaut, read once for all tests."""

import json

import pytest

from skinnet.cli import main
from tests.small_videos import Tracked, make_frames, write_video


@pytest.fixture(scope="session")
def tracked(tmp_path_factory: pytest.TempPathFactory) -> Tracked:
    folder = tmp_path_factory.mktemp("video")
    video = write_video(folder / "clip.mp4", make_frames())
    arguments = ["track", str(video), "-o", str(folder / "out"), "--baseline", "0,0.4", "-q"]
    assert main(arguments) == 0
    summary = json.loads((folder / "out" / "clip_track.json").read_text())
    return Tracked(video, folder / "out", summary)
