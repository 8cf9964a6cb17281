"""A white reference gives the white balance, and what is none is refused in a sentence."""

import math

import numpy as np
import pytest
import torch

from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, srgb_to_linear
from skinnet.inference import Capture
from skinnet.inference.capture import _TO_CAMERA
from skinnet.network._known_capture import KnownCapture
from skinnet.physics import Capture as PhysicalCapture
from skinnet.physics import SpectralCamera


def test_the_matrix_is_that_of_the_mean_camera() -> None:
    matrix = KnownCapture(SpectralCamera(dtype=torch.float64)).to_camera.numpy()
    np.testing.assert_allclose(_TO_CAMERA, matrix, atol=1e-6)


def test_fields_are_those_of_physics() -> None:
    assert Capture._fields == PhysicalCapture._fields
    assert Capture() == (None,) * 6


@pytest.mark.parametrize("balance", [(0.0, 0.0), (0.3, -0.4), (-0.2, 0.25), (0.05, -0.6)])
def test_a_cast_on_something_white_is_found(balance: tuple[float, float]) -> None:
    camera = SpectralCamera()
    capture = camera.standard()._replace(white_balance=torch.tensor(balance))
    white = camera(torch.full((33,), 0.3), capture).numpy()
    shown = linear_to_srgb(white)
    assert Capture.from_white(shown).white_balance == pytest.approx(balance, abs=1e-3)
    assert Capture.from_white(np.rint(255 * shown).astype(np.uint8)).white_balance == (
        pytest.approx(balance, abs=0.02)
    )


def test_it_is_what_the_network_finds() -> None:
    colour = np.array((220, 200, 170), np.uint8)
    known = KnownCapture(SpectralCamera())
    expected = known.find_white_balance(torch.from_numpy(srgb_to_linear(colour)))
    assert Capture.from_white(colour).white_balance == pytest.approx(expected.tolist(), abs=1e-5)
    assert Capture.from_white(colour.tolist()) == Capture.from_white(colour)
    assert Capture.from_white(colour / 255).white_balance == pytest.approx(expected.tolist(), 1e-4)


def test_the_exposure_of_grey_does_not_matter() -> None:
    linear = np.array((0.5, 0.4, 0.3))
    found = [Capture.from_white(linear_to_srgb(level * linear)) for level in (0.1, 0.5, 1.5)]
    for one in found:
        assert one.white_balance == pytest.approx(found[0].white_balance, abs=1e-4)


@pytest.mark.parametrize(
    ("colour", "sentence"),
    [
        ((255, 240, 220), r"\(255, 240, 220\) is overexposed: 250 .* Choose a darker part"),
        ((0.99, 0.9, 0.9), r"\(252, 230, 230\) is overexposed"),
        ((15, 14, 12), r"\(15, 14, 12\) is too dark: below 20 of 255 .* Choose something brighter"),
        ((0, 0, 0), "is too dark"),
        ((200, 90, 60), r"\(200, 90, 60\) is coloured: .* Choose something white or grey"),
        ((40, 0, 0), r"\(40, 0, 0\) is coloured"),
        ((255, 128, 0), r"\(255, 128, 0\) is coloured: .* It is overexposed, too. Choose some"),
        ((60, 90, 220), r"\(60, 90, 220\) is coloured"),
        ((300, 200, 200), r"integers of 0 to 255, or in floats of 0 to 1; got \(300, 200, 200\)"),
        ((200.0, 180.0, 170.0), r"floats of 0 to 1; got \(200, 180, 170\)"),
        ((-0.1, 0.5, 0.5), r"got \(-0.1, 0.5, 0.5\)"),
        ((float("nan"), 0.5, 0.5), r"got \(nan, 0.5, 0.5\)"),
        ((200, 180), r"one colour: .* Got \(200, 180\); give the mean of its pixels"),
        (((1, 2), 3, 4), "give the mean of its pixels"),
        (np.full((4, 4, 3), 128, np.uint8), "give the mean of its pixels"),
    ],
)
def test_what_is_no_white_reference_is_refused(colour: object, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        Capture.from_white(colour)


def test_a_known_reflectance_gives_the_exposure() -> None:
    assert Capture.from_white((118, 118, 118)).exposure is None
    card = Capture.from_white((118, 118, 118), reflectance=0.18)
    assert card.exposure == pytest.approx(math.log(0.1812 / 0.18), abs=0.003)
    bright = Capture.from_white((188, 188, 188), reflectance=0.5)
    assert bright.exposure == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("reflectance", [0.0, -0.1, 1.2, float("nan")])
def test_a_reflectance_that_cannot_be_is_refused(reflectance: float) -> None:
    with pytest.raises(InputError, match=r"A grey card has 0\.18"):
        Capture.from_white((118, 118, 118), reflectance)
