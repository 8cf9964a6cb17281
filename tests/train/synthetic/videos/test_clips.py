"""Synthetic clips are the same for a seed, move, and have the truth beside them."""

from pathlib import Path

import numpy as np
import pytest

from train.synthetic.videos.__main__ import main
from train.synthetic.videos.blood_course import BloodCourse, sample_course
from train.synthetic.videos.clip_renderer import ClipRenderer, ClipSettings
from train.synthetic.videos.clips import Clips
from train.synthetic.videos.head_motion import KINDS, displace, sample_motion


@pytest.fixture(scope="module")
def renderer(tmp_path_factory: pytest.TempPathFactory) -> ClipRenderer:
    folder = str(tmp_path_factory.mktemp("geometry"))
    clips = Clips(1, ClipSettings(1.0, 10.0, 160), heads=2, size=160, geometry=folder)
    return clips.make_renderer(clips.make_faces(), clips.plan(0))


def test_the_truth_follows_the_course(renderer: ClipRenderer) -> None:
    before, after = renderer.true_change(0.0), renderer.true_change(1.0)
    assert renderer.course.kind == "flush" and (after - before)[0] > 0.05
    seen = np.isfinite(after)
    assert seen.sum() > 3 and (after - before)[seen].min() > 0


def test_a_flush_makes_the_face_redder(renderer: ClipRenderer) -> None:
    before, after = (renderer.render(time).astype(float) for time in (0.0, 1.0))
    height, width = before.shape[:2]
    middle = slice(height * 3 // 8, height * 5 // 8), slice(width * 3 // 8, width * 5 // 8)
    ratio = after[middle].mean((0, 1)) / before[middle].mean((0, 1))
    assert ratio[0] > ratio[1]


def test_beats_have_their_rate_and_range() -> None:
    course = BloodCourse(72, 0.0, 0.04, "none", 1, 1, 0.3, False)
    times = np.arange(0, 10, 0.01)
    wave = course.beats(times)
    spectrum = np.abs(np.fft.rfft(wave - wave.mean()))
    assert np.fft.rfftfreq(len(wave), 0.01)[spectrum.argmax()] == pytest.approx(1.2, abs=0.05)
    assert np.ptp(wave) == pytest.approx(0.04, rel=0.02) and not course.event(times).any()


def test_samples_depend_on_the_seed_alone() -> None:
    first, second = (sample_course(np.random.default_rng(3), 0, 10.0) for _ in range(2))
    assert first == second


@pytest.mark.parametrize("kind", KINDS)
def test_movement_begins_at_rest(kind: str) -> None:
    motion = sample_motion(np.random.default_rng(0), kind)
    assert np.allclose(motion.pose(0.0), 0) and motion.gain(0.0) == 0
    assert np.abs(motion.pose(2.0)).max() > 0
    assert (kind == "talking") == bool(motion.expression(2.0).any())


def test_a_smile_moves_the_corners_of_the_mouth_alone() -> None:
    points = np.array([[[30.0, 70.0], [50.0, 10.0]]])
    mouth = np.array([[30.0, 70.0], [70.0, 70.0], [50.0, 70.0], [50.0, 30.0]])
    moved = displace(points, np.array([0.0, 1.0, 0.0]), mouth, 60.0) - points
    assert np.abs(moved[0, 0]).max() > 1 > np.abs(moved[0, 1]).max()


def test_bad_numbers_are_a_sentence(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["-o", str(tmp_path), "--clips", "0"]) == 2
    assert "Clips need" in capsys.readouterr().err
