"""The tone curve of a camera, and what the doubt of it does to ratios of colours."""

import numpy as np

from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.video._tone_doubt import USUAL, ToneDoubt

BASE = np.array([[0.35, 0.18, 0.12]])


def change_ratios(bend: float, gain: float) -> np.ndarray:
    """Log ratios of a gain alone, photographed with a bend, and read with the usual one."""
    camera = ToneCurve(bend=bend)
    before, after = (USUAL.undo(camera.apply(BASE * np.exp(each))) for each in (0.0, gain))
    return np.log(after / before) - gain


def test_light_that_holds_leaves_no_doubt() -> None:
    assert np.abs(ToneDoubt().find_covariance(BASE, np.zeros(1))).max() == 0


def test_the_usual_curve_is_exact() -> None:
    assert np.abs(change_ratios(USUAL.bend, 0.2)).max() < 1e-3


def test_the_error_of_another_bend_is_as_the_doubt_says() -> None:
    error = change_ratios(USUAL.bend + 0.15, 0.2)[0]
    told = ToneDoubt().find_covariance(BASE, np.array([0.2]))[0]
    assert np.allclose(np.outer(error, error), told, rtol=0.3, atol=3e-6)


def test_a_measured_curve_is_doubted_less() -> None:
    gains = np.array([0.2])
    told = ToneDoubt(USUAL).find_covariance(BASE, gains)
    assert np.trace(told[0]) < 0.1 * np.trace(ToneDoubt().find_covariance(BASE, gains)[0])
