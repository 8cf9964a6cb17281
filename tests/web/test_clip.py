"""A clip on the page is read as `skinnet track` reads it, and plays with its map."""

import base64
import csv
import io
import json
import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from page_steps import FIRST_MAPS_MS
from PIL import Image
from scipy.spatial import Delaunay
from skimage.data import astronaut
from small_videos import make_frames, write_video

from skinnet.images import find_faces
from skinnet.inference import Decomposer
from skinnet.inference._web.page_server import PageServer
from skinnet.video import Track, Tracker
from skinnet.video._frame_colours import FrameColours
from skinnet.video._readings import Reading
from skinnet.video._regions import NAMES
from skinnet.video._texture_space import SIZE, TextureSpace
from skinnet.video._track_files import COLUMNS
from skinnet.video._video_frames import VideoFrames
from train.synthetic.videos.clip_files import write_clip
from train.synthetic.videos.clip_renderer import ClipSettings
from train.synthetic.videos.clips import Clips

pytestmark = pytest.mark.slow

BASELINE = 0.8


class InPython(NamedTuple):
    """What Python reads of the clip."""

    readings: list[Reading]
    track: Track


@pytest.fixture(scope="module", autouse=True)
def _require_library(server: PageServer) -> None:
    if "/runtime/mediabunny.min.mjs" not in server.files:
        pytest.skip("Mediabunny is not there: make runtime")


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a synthetic face that flushes."""
    pytest.importorskip("av")
    folder = tmp_path_factory.mktemp("clip")
    clips = Clips(1, ClipSettings(3.0, 10.0, 200), heads=2, size=200, geometry=str(folder))
    plan = clips.plan(0)
    write_clip(folder / "clip.mp4", clips.make_renderer(clips.make_faces(), plan), 14)
    return folder / "clip.mp4"


@pytest.fixture(scope="module")
def in_python(clip: Path) -> InPython:
    tracker = Tracker(Decomposer(threads=1), baseline=(0, BASELINE))
    frames = VideoFrames(clip, clip.name)
    readings = [one for frame in frames for one in tracker.add(frame.pixels, frame.time)]
    track = tracker.finish()
    return InPython([*readings, *tracker.waiting], track)


@pytest.fixture(scope="module")
def clip_page(server: PageServer, browser: Any, clip: Path) -> Iterator[Any]:
    """The page with the clip read; tests leave it as they found it."""
    context = browser.new_context(viewport={"width": 1280, "height": 1600})
    page = context.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(server.address)
    page.evaluate(f"document.getElementById('clip-baseline').value = {BASELINE}")
    page.set_input_files("#file", str(clip))
    page.locator("#clip-result").wait_for(timeout=FIRST_MAPS_MS)
    yield page
    context.close()
    assert not faults


@pytest.fixture(scope="module")
def page(server: PageServer, browser: Any) -> Iterator[Any]:
    """The page, in which tests open one clip after the other."""
    context = browser.new_context()
    page = context.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(server.address)
    yield page
    context.close()
    assert not faults


def download(page: Any, button: str) -> tuple[str, str]:
    """The name and the text of a file that the page gives."""
    with page.expect_download() as waiting:
        page.click(button)
    return waiting.value.suggested_filename, Path(waiting.value.path()).read_text("utf-8")


def test_changes_are_those_of_python(clip_page: Any, in_python: InPython) -> None:
    name, text = download(clip_page, "#save-table")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert name == "clip_track.csv"
    assert list(rows[0]) == [each for each in COLUMNS if not each.startswith("pulse_")]
    assert [row["state"] for row in rows] == [one.state for one in in_python.readings]
    times = [float(row["time"]) for row in rows]
    np.testing.assert_allclose(times, [one.time for one in in_python.readings], atol=2e-3)
    # Browser and FFmpeg round colours differently, of which regions of few pixels show more.
    for region, least, most in ((0, 0.98, 0.02), (1, 0.98, 0.03), (2, 0.98, 0.05)):
        found = np.array([float(row[f"{NAMES[region]}_log_ratio"]) for row in rows])
        expected = np.array([one.change[region] for one in in_python.readings])
        assert expected.max() > 0.1
        assert np.corrcoef(found, expected)[0, 1] > least, NAMES[region]
        assert np.sqrt(((found - expected) ** 2).mean()) < most, NAMES[region]
    sds = np.array([float(row["face_log_ratio_sd"]) for row in rows])
    expected = np.array([one.change_sd[0] for one in in_python.readings])
    assert np.median(sds / expected) == pytest.approx(1, abs=0.15)


def test_the_summary_has_what_is_computed(clip_page: Any, in_python: InPython) -> None:
    name, text = download(clip_page, "#save-summary")
    summary, expected = json.loads(text), in_python.track.to_dict()
    assert name == "clip_track.json" and summary["complete"] is True
    known = {*expected, "file", "complete", "series"}
    assert known - set(summary) == {"pulse", "events", "version"}
    assert set(summary) <= known
    for key in ("seconds", "frames", "shots", "model", "disclaimer"):
        assert summary[key] == expected[key], key
    for pigment in ("melanin", "resting_hemoglobin"):
        found, wanted = summary[pigment]["face"], expected[pigment]["face"]
        assert found["mean"] == pytest.approx(wanted["mean"], rel=0.05)
        assert set(found) == set(wanted) and list(summary[pigment]) == list(expected[pigment])
    assert list(summary["least_change"]) == list(expected["least_change"])
    least = summary["least_change"]["face"], expected["least_change"]["face"]
    assert least[0] == pytest.approx(least[1], rel=0.15)
    found, wanted = summary["melanin_constancy"], expected["melanin_constancy"]
    assert set(found) == set(wanted) and len(found["looks"]) == len(wanted["looks"])
    assert found["spread"] == pytest.approx(wanted["spread"], abs=0.01)
    row = summary["series"][-1]
    assert set(row) == {"frame", "time", "shot", "state", "gain", "regions"}
    assert list(row["regions"]) == list(NAMES)


def read_map(page: Any, time: float) -> NDArray[np.uint8]:
    """The map over the clip at a time, [h, w, 4]."""
    page.evaluate(
        """async (time) => {
            const video = document.getElementById("clip-video");
            video.pause();
            video.currentTime = time;
            await new Promise((resume) => video.addEventListener("seeked", resume, { once: true }));
            await new Promise((resume) => setTimeout(resume, 100));
        }""",
        time,
    )
    address = page.evaluate("document.getElementById('clip-map').toDataURL()")
    content = base64.b64decode(address.partition(",")[2])
    return np.array(Image.open(io.BytesIO(content)))


def test_the_map_is_drawn_in_step(
    clip_page: Any, clip: Path, in_python: InPython, tmp_path: Path
) -> None:
    before, after = (read_map(clip_page, time) for time in (0.25, 2.75))
    (face,) = find_faces(next(iter(VideoFrames(clip, "clip"))).pixels)
    height, width = after.shape[:2]
    box = np.array(face.box) * width // 200
    inside = np.zeros((height, width), bool)
    inside[box[1] : box[3], box[0] : box[2]] = True
    for drawn in (before, after):
        shown = drawn[..., 3] > 128
        assert 0.25 < shown[inside].mean() < 1 and shown[~inside].mean() < 0.15

    def redness(drawn: NDArray[np.uint8]) -> float:
        pixels = drawn[drawn[..., 3] > 128].astype(float)
        return float((pixels[:, 0] - pixels[:, 2]).mean())

    assert redness(after) > redness(before) + 15
    text = clip_page.locator("#clip-regions tbody tr").first.inner_text()
    assert text.startswith("Face") and "+" in text and " to " in text
    label = clip_page.get_attribute("#clip-course", "aria-label")
    assert "that of the face is between" in label
    clip_page.uncheck("#clip-shown")
    assert not read_map(clip_page, 2.7)[..., 3].any()
    clip_page.check("#clip-shown")


def test_the_disclaimer_and_what_is_missing_stand_beside_it(clip_page: Any) -> None:
    shown = " ".join(clip_page.inner_text("#clip-result").split())
    assert "This is no medical device: it must not be used to diagnose, treat or monitor." in shown
    assert "The page computes neither pulse nor events" in shown


def open_clip(page: Any, name: str, content: bytes, type_: str = "video/mp4") -> None:
    page.set_input_files("#file", {"name": name, "mimeType": type_, "buffer": content})


def make_video(
    path: Path, frames: list[NDArray[np.uint8]], codec: str = "libx264", rate: int = 20
) -> bytes:
    av = pytest.importorskip("av")
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=rate)
        stream.height, stream.width = frames[0].shape[:2]
        stream.pix_fmt = "yuv420p"
        for pixels in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(pixels, format="rgb24")))
        container.mux(stream.encode())
    return path.read_bytes()


def test_what_cannot_be_read_is_a_sentence(page: Any, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    noise = list(rng.integers(0, 255, (3, 64, 64, 3), np.uint8))
    wall = [np.full((64, 64, 3), level, np.uint8) for level in range(100, 160, 4)]
    cases = {
        "is no video that this page can read": b"not a video" * 100,
        "cannot decode other.mp4 (its codec is": make_video(
            tmp_path / "a.mp4", noise, "mpeg4", rate=10
        ),
        "lasts 130 seconds, and at most 120 are read here; cut it, or the command skinnet track": (
            make_video(tmp_path / "b.mp4", wall[:1] * 130, rate=1)
        ),
        "it is a still image": make_video(tmp_path / "c.mp4", wall[:1] * 4),
        "No face was found in the 15 frames": make_video(tmp_path / "d.mp4", wall),
    }
    for sentence, content in cases.items():
        open_clip(page, "other.mp4", content)
        page.locator("#error").filter(has_text=sentence).wait_for(timeout=FIRST_MAPS_MS)
        assert page.locator("#clip-result").is_hidden() and page.locator("#clip-work").is_hidden()


def test_the_page_asks_which_face_is_meant(page: Any, tmp_path: Path) -> None:
    pytest.importorskip("av")
    frames = [np.hstack([each, each[:, ::-1]]) for each in make_frames(6)]
    content = write_video(tmp_path / "two.mp4", frames).read_bytes()
    open_clip(page, "two.mp4", content)
    second = page.get_by_label("Face 2 of 2")
    second.wait_for(timeout=FIRST_MAPS_MS)
    assert "The video shows 2 faces. Which one is meant?" in page.inner_text("#status")
    second.focus()
    page.keyboard.press("Enter")
    page.locator("#clip-result").wait_for(timeout=FIRST_MAPS_MS)
    page.wait_for_timeout(300)
    drawn = read_map(page, 0.1)[..., 3] > 0
    assert drawn[:, drawn.shape[1] // 2 :].sum() > 10 * drawn[:, : drawn.shape[1] // 2].sum()


def test_the_rotation_of_a_phone_is_applied(page: Any, tmp_path: Path) -> None:
    pytest.importorskip("av")
    turned = [np.ascontiguousarray(np.rot90(each)) for each in make_frames(6)]
    content = bytearray(write_video(tmp_path / "phone.mp4", turned).read_bytes())
    start = content.index(b"tkhd") + 44  # the display matrix of a version 0 header
    clockwise = (0, 1 << 16, 0, -(1 << 16), 0, 0, 256 << 16, 0, 1 << 30)
    content[start : start + 36] = struct.pack(">9i", *clockwise)
    open_clip(page, "phone.mp4", bytes(content))
    page.locator("#clip-result").wait_for(timeout=FIRST_MAPS_MS)
    page.wait_for_timeout(300)
    rows, columns = np.nonzero(read_map(page, 0.1)[..., 3])
    (face,) = find_faces(make_frames(1)[0])
    height, width = face.box.height, face.box.width
    assert abs(rows.mean() - (face.box.top + face.box.bottom) / 2) < 0.15 * height
    assert abs(columns.mean() - (face.box.left + face.box.right) / 2) < 0.15 * width


def test_a_clip_is_recorded_by_the_camera(page: Any) -> None:
    page.click("#use-camera")
    page.locator("#camera video").evaluate(
        "(video) => new Promise((done) => video.requestVideoFrameCallback(done))"
    )
    page.get_by_text("Record a clip").click()
    page.wait_for_timeout(1500)
    page.get_by_text("Stop recording").click()
    # A busy machine may record one frame alone.
    sentence = re.compile("No face was found in the|it is a still image")
    page.locator("#error").filter(has_text=sentence).wait_for(timeout=FIRST_MAPS_MS)
    assert not page.locator("#camera").evaluate("(dialog) => dialog.open")


def test_vp9_is_read_and_reading_can_be_stopped(page: Any, tmp_path: Path) -> None:
    content = make_video(tmp_path / "clip.webm", make_frames(80), "libvpx-vp9")
    open_clip(page, "clip.webm", content, "video/webm")
    page.locator("#clip-done").filter(has_text="frames").wait_for(timeout=FIRST_MAPS_MS)
    page.locator("#clip-cancel").focus()
    page.keyboard.press("Enter")
    page.locator("#clip-result").wait_for(timeout=FIRST_MAPS_MS)
    _, text = download(page, "#save-summary")
    summary = json.loads(text)
    assert summary["complete"] is False and 0 < summary["frames"]["read"] < 80
    assert "It was cancelled" in page.inner_text("#clip-notes")
    page.click("#sample")
    page.locator("#maps").wait_for(timeout=FIRST_MAPS_MS)
    assert page.locator("#clip").is_hidden()


def test_the_texture_space_is_that_of_python(open_page: Callable[..., Any]) -> None:
    page = open_page("licences.txt")  # without the networks
    landmarks = find_faces(astronaut())[0].landmarks[:468]
    found = page.evaluate(
        """async (landmarks) => {
            const { TextureSpace } = await import("/src/video/texture_space.js");
            const { USUAL_LINEAR } = await import("/src/video/tone_curve.js");
            const space = TextureSpace.fromLandmarks(landmarks);
            return {
                triangles: space.triangles,
                inside: space.places,
                regions: space.regions.map((mask) => [...mask]),
                points: [...space.place(landmarks)],
                linear: [...USUAL_LINEAR],
            };
        }""",
        landmarks.tolist(),
    )
    space = TextureSpace.from_landmarks(landmarks)
    expected = Delaunay(space.landmarks).simplices

    def sort(triangles: Any) -> set[tuple[int, ...]]:
        return {tuple(sorted(each)) for each in np.asarray(triangles).tolist()}

    common = sort(found["triangles"]) & sort(expected)
    assert len(common) > 0.99 * len(expected)
    inside = np.flatnonzero(space.inside)
    shared = np.intersect1d(found["inside"], inside)
    assert len(shared) > 0.995 * len(inside) > 0.3 * SIZE**2
    regions = np.zeros((len(NAMES), SIZE**2), bool)
    regions[:, found["inside"]] = np.array(found["regions"], bool)
    differing = regions != space.regions.reshape(len(NAMES), -1)
    assert (differing.sum(1) <= 0.02 * space.regions.sum((1, 2)) + 2).all()
    np.testing.assert_allclose(found["linear"], FrameColours()._table, atol=1e-6)
    placed = np.full((SIZE**2, 2), np.nan)
    placed[found["inside"]] = np.reshape(found["points"], (-1, 2))
    apart = np.abs(placed[shared] - space.fill(space.place(landmarks)).reshape(-1, 2)[shared])
    assert apart.max() < 0.5
