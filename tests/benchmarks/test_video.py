"""Scores of clips whose reading is made up."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks import video
from benchmarks.pulse_baselines import METHODS, estimate_pulse
from benchmarks.video import (
    measure,
    measure_change,
    measure_coverage,
    measure_melanin,
    measure_onset,
    measure_peers,
    measure_pulse,
    measure_strong,
)
from benchmarks.video_clips import ClipScore, StrongScore, find_tone
from benchmarks.video_peers import list_peers
from skinnet.errors import InputError
from skinnet.video._regions import NAMES
from train.synthetic.videos.blood_course import sample_course
from train.synthetic.videos.clips import ClipPlan, Clips
from train.synthetic.videos.head_motion import sample_motion


def make_score(error: float = 0.0, sd: float = 0.05, rate_error: float = 1.0) -> ClipScore:
    rng = np.random.default_rng(0)
    course = sample_course(rng, 0, 12.0)
    plan = ClipPlan(0, 0.05, course, sample_motion(rng, "still"), 12)
    truth = np.linspace(0, 0.5, 40)[:, None] * np.ones(len(NAMES))
    pulse = dict.fromkeys(METHODS, course.rate + 3) | {"skinnet": course.rate - rate_error}
    onset = course.onset + 0.2
    change = truth + error
    return ClipScore(
        plan,
        "light",
        truth,
        change,
        np.full_like(truth, sd),
        pulse,
        True,
        onset,
        0,
        (0.05, 0.051),
        0.3,
    )


def test_a_perfect_reading_is_perfect() -> None:
    found = measure_change([make_score()])
    assert found["face"]["r"] == pytest.approx(1) and found["face"]["rmse"] == 0
    assert found["readable"]["clips"] == 1
    assert measure_change([make_score(sd=0.4)])["readable"]["clips"] == 0
    assert measure_coverage([make_score(0.05), make_score(0.2)])["all"] == 0.5


def test_errors_are_those_that_were_made() -> None:
    scores = [make_score(rate_error=1.0), make_score(rate_error=-2.0)]
    assert measure_pulse(scores)["skinnet"] == pytest.approx(1.5)
    assert measure_pulse(scores)["pos"] == pytest.approx(3)
    assert measure_onset(scores)["mean_absolute_s"] == pytest.approx(0.2)
    assert measure_melanin(scores)["read_again_median"] == pytest.approx(0.02)


def test_clips_that_are_compressed_strongly_are_scored_apart() -> None:
    truth = np.zeros((20, len(NAMES)))
    strong = StrongScore(0.02, truth, truth + 0.1, np.full_like(truth, 0.1))
    scores = [make_score()._replace(strong=strong), make_score()]
    found = measure_strong(scores)
    assert found == {"clips": 1, "bits_per_pixel": 0.02, "all": 1.0, "still": 1.0}
    assert measure_strong(scores[1:]) is None


def test_drift_is_that_of_the_looks() -> None:
    scores = [make_score()._replace(constancy={"drift": drift, "spread": 0.02})
              for drift in (-0.01, 0.03)]  # fmt: skip
    found = measure_melanin(scores)
    assert found["drift_median"] == pytest.approx(0.02) and found["standard_error"] is None


def test_a_run_that_was_cut_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    count: list[int] = []

    def score(clips, data, number, *rest):
        count.append(number)
        return make_score()

    monkeypatch.setattr(video, "score_clip", score)
    for _ in range(2):
        assert video._score(Clips(4), None, 1, None, [], tmp_path).bits == 0.3
    assert count == [1] and [each.suffix for each in tmp_path.iterdir()] == [".pickle"]


@pytest.mark.parametrize("name", METHODS)
def test_baselines_find_the_rate_of_clean_skin(name: str) -> None:
    times = np.arange(0, 14, 1 / 30)
    beat = np.sin(2 * np.pi * 1.25 * times)
    ratios = 0.01 * beat[:, None] * np.array([-0.3, -1.0, -0.7])
    assert estimate_pulse(times, ratios, METHODS[name]) == pytest.approx(75, abs=1.5)


def test_tones_are_those_of_the_typology() -> None:
    assert [find_tone(melanin, 0.04) for melanin in (0.02, 0.1, 0.25)] == [
        "light",
        "medium",
        "dark",
    ]


def test_a_folder_without_networks_has_no_peers(tmp_path: Path) -> None:
    assert list_peers(tmp_path) == [] and measure_peers([make_score()], []) is None
    with pytest.raises(InputError, match="no folder"):
        list_peers(tmp_path / "absent")


def test_bad_numbers_are_a_sentence() -> None:
    with pytest.raises(InputError, match="clips is 1"):
        measure(clips=0)
