"""A chart in a photograph gives balance, exposure, tone curve, light and camera."""

import math
from typing import Any

import numpy as np
import pytest
import torch

from benchmarks.chart_pictures import View, find_white, load_patches, photograph, place_corners
from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.inference import Capture, CaptureProfile
from skinnet.inference._references.chart import Chart
from skinnet.inference._references.chart_detection import find_chart
from skinnet.inference._references.chart_reading import read_samples
from skinnet.inference._references.patch_samples import PatchSamples
from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.inference.capture import _TO_CAMERA
from skinnet.physics import LIGHTS, SkinReflectance, SpectralCamera
from skinnet.physics import Capture as PhysicalCapture

PLAIN = View("D65", 5, exposure=0.6)


def samples_of(capture: PhysicalCapture, chart: Chart, tone: ToneCurve, level: float = 0.6) -> Any:
    matrix = SpectralCamera(dtype=torch.float64).matrix(capture).numpy()
    linear = ToneCurve().undo(tone.apply(level * chart.spectra @ matrix))
    return PatchSamples(linear, np.zeros(24), (linear > 0.955).any(1)), level * matrix


def make_capture(light: str, seed: int) -> PhysicalCapture:
    rng = np.random.default_rng(seed)
    weights = torch.zeros(len(LIGHTS), dtype=torch.float64)
    weights[LIGHTS.index(light)] = 1
    return PhysicalCapture(
        weights,
        torch.tensor(5200.0, dtype=torch.float64),
        torch.tensor(rng.normal(0, 1, 6)),
        torch.tensor(rng.normal(0, 0.1, 2)),
    )


@pytest.mark.parametrize(("light", "seed"), [("D", 0), ("A", 1), ("FL11", 2), ("LED-B3", 3)])
def test_light_camera_and_tone_are_recovered(light: str, seed: int, classic: Chart) -> None:
    true, tone = make_capture(light, seed), ToneCurve(0.14, 0.5, 0.01, 0.06)
    samples, matrix = samples_of(true, classic, tone)
    found = read_samples(samples, classic, "The chart")
    assert found.capture.light == {light: 1.0}
    assert np.subtract(found.tone, tone) == pytest.approx(0, abs=0.12)
    known = found.linear_capture
    white = matrix.sum(0)
    red, green, blue = np.log(_TO_CAMERA @ white)
    assert known.white_balance == pytest.approx((red - green, blue - green), abs=0.01)
    assert known.exposure == pytest.approx(math.log(white @ (0.2126, 0.7152, 0.0722)), abs=0.02)
    # What counts is skin's colour relative to white under light and camera together.
    told = PhysicalCapture(
        true.light,
        torch.tensor(known.temperature or 6504.0, dtype=torch.float64),
        torch.tensor(known.camera, dtype=torch.float64),
        torch.zeros(2, dtype=torch.float64),
    )
    camera = SpectralCamera(dtype=torch.float64)
    skin = SkinReflectance(dtype=torch.float64).bands(
        torch.tensor([0.02, 0.05, 0.2]), torch.tensor([0.03, 0.08, 0.05])
    )
    standard = skin @ camera.matrix(camera.standard())
    seen = skin @ camera.matrix(true._replace(white_balance=torch.zeros(2, dtype=torch.float64)))
    error = (skin @ camera.matrix(told) / seen).log().abs().mean()
    assert error < 0.04 and error < 0.8 * (standard / seen).log().abs().mean()


def test_a_linear_photograph_is_known_as_one(classic: Chart) -> None:
    samples, _ = samples_of(make_capture("D", 4), classic, ToneCurve())
    found = read_samples(samples, classic, "The chart")
    assert found.capture.linear and found.tone == ToneCurve()
    assert np.nanmean(found.delta_e) < 3


def test_a_chart_of_colours_alone_gives_the_balance(classic: Chart) -> None:
    true = make_capture("D", 5)
    samples, matrix = samples_of(true, classic, ToneCurve(0.1, 0.4))
    found = read_samples(samples, classic._replace(spectra=None), "The chart")
    assert found.capture.light is None and found.light_shares == {}
    red, green, blue = np.log(_TO_CAMERA @ matrix.sum(0))
    assert found.linear_capture.white_balance == pytest.approx(
        (red - green, blue - green), abs=0.02
    )


def test_patches_in_the_shade_are_left_out(classic: Chart) -> None:
    samples, matrix = samples_of(make_capture("D", 6), classic, ToneCurve())
    shaded = classic.cells[:, 0] < 2
    dark = samples._replace(linear=np.where(shaded[:, None], 0.5 * samples.linear, samples.linear))
    found = read_samples(dark, classic, "The chart")
    assert not found.lit[shaded].any() and found.lit[~shaded].all()
    assert found.linear_capture.exposure == pytest.approx(
        math.log(matrix.sum(0) @ (0.2126, 0.7152, 0.0722)), abs=0.02
    )


def _scale(factor: Any) -> Any:
    return lambda linear, chart: linear * factor(chart)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (_scale(lambda chart: 4.0), r"is overexposed: \d+ of its 24 patches .* stays below 250"),
        (_scale(lambda chart: 0.02), r"is too dark: its brightest patch has 1\.\d% of white"),
        (
            _scale(lambda chart: np.where(chart.cells[:, :1] < 3, 0.4, 1)),
            r"is not in one light: only 1\d of its 24 patches are evenly lit",
        ),
        (
            _scale(lambda chart: np.where(chart.cells[:, :1] < 3, (1, 0.6, 0.3), (0.4, 0.7, 1))),
            "not in one light|does not have the chart's colours",
        ),
        (lambda linear, chart: np.random.default_rng(0).permutation(linear), "light|colours"),
        (
            _scale(lambda chart: (1.3, 0.3, 0.1)),
            "is in strongly coloured light: .* Set the camera's white balance",
        ),
    ],
)
def test_what_cannot_be_trusted_is_refused(change: Any, sentence: str, classic: Chart) -> None:
    samples, _ = samples_of(make_capture("D", 7), classic, ToneCurve(0.1, 0.4))
    linear = change(samples.linear, classic).clip(0, 1)
    wrong = PatchSamples(linear, np.zeros(24), (linear > 0.955).any(1))
    with pytest.raises(InputError, match=sentence):
        read_samples(wrong, classic, "The chart")


@pytest.mark.slow
@pytest.mark.parametrize("turn", [0, 1])
def test_a_tilted_chart_is_found(turn: int, classic: Chart) -> None:
    view = PLAIN._replace(tilt=30, axis=70, roll=170, seed=3)
    photo = np.rot90(photograph(view), turn)
    found = find_chart(read_picture(np.ascontiguousarray(photo)), classic)
    expected = place_corners(view)
    if turn:
        expected = np.c_[expected[:, 1], photo.shape[0] - expected[:, 0]]
    assert np.abs(found.corners - expected).max() < 3


@pytest.mark.slow
def test_white_is_found_through_the_tone_curve(profile: CaptureProfile, shot_view: View) -> None:
    red, green, blue = np.log(_TO_CAMERA @ find_white(shot_view))
    assert profile.linear_capture is not None and profile.tone is not None
    assert profile.linear_capture.white_balance == pytest.approx(
        (red - green, blue - green), abs=0.02
    )
    assert profile.delta_e is not None and profile.delta_e[0] < 3
    assert profile.source == ("chart.png", "classic")


@pytest.mark.slow
def test_the_classmethod_is_the_profile(chart_file: Any, profile: CaptureProfile) -> None:
    assert Capture.from_chart(chart_file) == profile.capture


@pytest.mark.slow
def test_cut_and_other_charts_and_none_are_refused(classic: Chart) -> None:
    with pytest.raises(InputError, match=r"is cut: \d+ of its 24 patches are not in the picture"):
        CaptureProfile.from_chart(photograph(PLAIN._replace(width=1.2)))
    other = np.random.default_rng(0).permutation(load_patches()).reshape(4, 6, 33)
    with pytest.raises(InputError, match=r"grid of 2\d patches .* not have the colours"):
        CaptureProfile.from_chart(photograph(PLAIN, other))
    with pytest.raises(InputError, match="No classic chart was found in The array"):
        CaptureProfile.from_chart(np.full((200, 300, 3), 120, np.uint8))
