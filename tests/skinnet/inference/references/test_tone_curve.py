"""Tone curves are those of the training's cameras, and can be undone."""

import numpy as np
import torch

from skinnet.images import read_picture, to_uint8
from skinnet.inference._references.linearisation import linearise, restore_tones
from skinnet.inference._references.tone_curve import ToneCurve
from train.synthetic.photography.simulated_camera import apply_tone_curve

TONE = ToneCurve(0.14, 0.5, 0.01, 0.08)


def test_it_is_the_curve_of_the_training() -> None:
    linear = np.linspace(0, 1, 60).reshape(20, 3)
    own = ToneCurve(0.14, 0.5).apply(linear)
    image = torch.from_numpy(linear.T.copy())[None, :, None]
    expected = apply_tone_curve(torch.tensor([[0.14, 0.5]], dtype=torch.float64), image)
    np.testing.assert_allclose(own, expected[0, :, 0].T.numpy(), atol=1e-6)


def test_it_is_undone() -> None:
    linear = np.random.default_rng(0).uniform(0.02, 0.5, (200, 3)) * (1, 0.9, 0.8)
    np.testing.assert_allclose(TONE.undo(TONE.apply(linear)), linear, atol=2e-3)


def test_a_photograph_is_linearised_and_restored() -> None:
    linear = np.random.default_rng(1).uniform(0.05, 0.5, (300, 8, 1)) * (1, 0.8, 0.7)
    photo = to_uint8(TONE.apply(linear))
    straight = linearise(read_picture(photo), TONE)
    assert np.abs(straight.linear() - linear).max() < 0.01
    assert np.abs(restore_tones(straight.srgb, TONE).astype(int) - photo).max() <= 2
