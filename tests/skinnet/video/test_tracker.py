"""The tracker, fed with frames."""

import numpy as np
import pytest
from skimage.data import astronaut

from skinnet.errors import InputError
from skinnet.inference import Decomposer
from skinnet.video import Tracker
from skinnet.video._regions import FACE, NAMES
from tests.small_videos import RATE, make_frames


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


def follow(tracker: Tracker, frames: list[np.ndarray], start: float = 0.0) -> list:
    return [
        reading
        for number, frame in enumerate(frames)
        for reading in tracker.add(frame, start + number / RATE)
    ]


def test_exposure_cancels_and_blood_does_not(decomposer: Decomposer) -> None:
    dark = [(0.8 * each).astype(np.uint8) for each in make_frames(4, 0)]
    tracker = Tracker(decomposer, baseline=(0, 0.3), looks=2, maps=False)
    readings = follow(tracker, make_frames(10, 0) + dark + make_frames(8)[-1:])
    change = np.array([each.change[NAMES.index(FACE)] for each in readings])
    assert np.abs(change[10:14]).max() < 0.06 < change[-1]
    assert readings[11].gain[0] < 0.8


def test_exposure_that_drifts_is_no_blood_and_widens_the_interval(decomposer: Decomposer) -> None:
    still = make_frames(14, 0)
    drift = [np.rint(each * (1 - 0.02 * max(0, number - 6))).astype(np.uint8)
             for number, each in enumerate(still)]  # fmt: skip
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    readings = follow(tracker, drift)
    change = np.array([[each.change[0], each.change_sd[0]] for each in readings])
    assert (np.abs(change[7:, 0]) < 1.645 * change[7:, 1]).all()
    assert change[-1, 1] > 1.5 * change[5, 1] and readings[-1].gain[0] < 0.85
    assert not tracker.finish().events


def test_melanin_is_one_number(decomposer: Decomposer) -> None:
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    follow(tracker, make_frames(8))
    track = tracker.finish()
    assert track.frames == {"read": 8, "lost": 0, "hidden": 0}
    assert track.melanin[FACE]["mean"] > 0 and "melanin" not in repr(tracker.waiting)


def test_melanin_is_pooled_from_looks_through_the_whole_video(decomposer: Decomposer) -> None:
    frames = make_frames(6, 0)
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    follow(tracker, frames)
    follow(tracker, frames[:1], 3.0)
    follow(tracker, frames[1:2], 6.0)
    track = tracker.finish()
    looks = [one["mean"] for one in track.constancy["looks"]]
    assert [one["time"] for one in track.constancy["looks"]] == [0.0, 0.2, 3.0, 6.0]
    assert min(looks) < track.melanin[FACE]["mean"] < max(looks)
    assert abs(track.constancy["drift"]) < 0.05


def test_the_least_change_is_that_of_the_noise(decomposer: Decomposer) -> None:
    rng, least = np.random.default_rng(0), []
    for noise in (0.0, 20.0):
        frames = [(each + rng.normal(0, noise, each.shape)).clip(0, 255).astype(np.uint8)
                  for each in make_frames(8, 0)]  # fmt: skip
        tracker = Tracker(decomposer, baseline=(0, 0.3), looks=1, maps=False)
        follow(tracker, frames)
        least.append(tracker.finish().least_change[FACE])
    assert 0 < 1.2 * least[0] < least[1]


def test_a_cut_begins_a_shot_and_a_lost_face_is_said(decomposer: Decomposer) -> None:
    photo = astronaut()
    wall = np.random.default_rng(0).integers(90, 110, (256, 256, 3)).astype(np.uint8)
    other = photo[:256, 100:356][:, ::-1].copy()
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    readings = follow(tracker, [*make_frames(6, 0), wall, wall, *[other] * 6])
    track = tracker.finish()
    assert track.frames["lost"] == 2 and any("cut" in each for each in track.notes)
    assert [each["number"] for each in track.shots] == [1, 2]
    assert {each.state for each in readings} == {"read", "lost"}


def make_grey(frame: np.ndarray) -> np.ndarray:
    return np.repeat(frame.mean(2, keepdims=True), 3, 2).astype(np.uint8)


def test_a_frame_without_colour_is_passed_over(decomposer: Decomposer) -> None:
    frames = make_frames(8, 0)
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    follow(tracker, [make_grey(frames[0]), *frames[1:]])
    assert tracker.finish().frames["read"] == 8


def test_a_shot_that_cannot_be_read_is_said(decomposer: Decomposer) -> None:
    other = make_grey(astronaut()[:256, 100:356][:, ::-1].copy())
    tracker = Tracker(decomposer, baseline=(0, 0.2), looks=2, maps=False)
    follow(tracker, [*make_frames(6, 0), *[other] * 8])
    track = tracker.finish()
    assert track.frames == {"read": 6, "lost": 0, "hidden": 8} and len(track.shots) == 1
    assert any("is not read: There is no colour" in each for each in track.notes)
    alone = Tracker(decomposer, baseline=(0, 0.2), maps=False)
    with pytest.raises(InputError, match="no colour"):
        follow(alone, [other] * 8)
    short = Tracker(decomposer, maps=False)
    follow(short, [other] * 4)
    with pytest.raises(InputError, match="no colour"):
        short.finish()


def test_times_must_increase(decomposer: Decomposer) -> None:
    tracker = Tracker(decomposer)
    tracker.add(astronaut(), 1.0)
    with pytest.raises(InputError, match="increase"):
        tracker.add(astronaut(), 1.0)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [({"baseline": (3, 1)}, "baseline"), ({"looks": 0}, "looks"), ({"face": 0}, "face is")],
)
def test_arguments_are_checked(decomposer: Decomposer, arguments: dict, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Tracker(decomposer, **arguments)


def test_a_baseline_beyond_the_end_is_said(decomposer: Decomposer) -> None:
    tracker = Tracker(decomposer, baseline=(20, 25), maps=False)
    follow(tracker, [astronaut()] * 3)
    with pytest.raises(InputError, match="The baseline begins at 20 s"):
        tracker.finish()


def test_a_video_that_is_all_baseline_is_said(decomposer: Decomposer) -> None:
    tracker = Tracker(decomposer, maps=False)
    follow(tracker, [astronaut()] * 3)
    assert any("compared with itself" in note for note in tracker.finish().notes)
