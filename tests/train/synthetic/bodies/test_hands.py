"""Hands have a back with nails, and bend towards their palm."""

import numpy as np

from train.synthetic.bodies.hands import Pose, make_hand, sample_pose
from train.synthetic.labels import NAIL, SKIN


def test_a_flat_hand_is_as_long_as_a_hand_and_shows_five_nails_on_its_back() -> None:
    hand = make_hand(Pose(np.full((4, 3), 0.05), 0.1, 0.2))
    low, high = hand.vertices.min(0), hand.vertices.max(0)
    # 18 to 20 cm in half heads of 11.5 cm.
    assert 18 / 11.5 < high[1] < 20 / 11.5 and low[1] > -0.25
    assert set(np.unique(hand.label)) == {SKIN, NAIL}
    nails = hand.vertices[hand.triangles[hand.label == NAIL]].mean(1)
    fingers = nails[nails[:, 1] > 1]
    assert (fingers[:, 2] > -0.12).all()
    assert len(np.unique((nails[nails[:, 1] > 1.15, 0] / 0.12).round())) >= 3


def test_a_fist_is_short_and_bends_away_from_its_back() -> None:
    flat, fist = (make_hand(Pose(np.full((4, 3), bend), 0.0, 0.2)) for bend in (0.05, 1.3))
    assert fist.vertices[:, 1].max() < 0.75 * flat.vertices[:, 1].max()
    assert fist.vertices[:, 2].min() < flat.vertices[:, 2].min() - 0.05


def test_the_thumb_is_that_of_a_right_hand() -> None:
    hand = make_hand(sample_pose(np.random.default_rng(0)))
    assert hand.vertices[:, 0].min() < -hand.vertices[:, 0].max() - 0.1
