"""Shares of open mouths."""

import numpy as np
import pytest

from train.synthetic.bodies.bald_procedural import make_bald_procedural
from train.synthetic.bodies.expression import OPEN_MOUTH_SHARE, sample_any_expression
from train.synthetic.labels import TEETH

NAMES = ("jawOpen", "mouthUpperUp_L", "mouthSmile_L", "mouthFrown_L")


def test_one_third_of_all_mouths_is_open_and_most_of_these_show_teeth() -> None:
    weights = np.array(
        [
            sample_any_expression(NAMES, np.zeros(2), np.random.default_rng(seed))
            for seed in range(1500)
        ]
    )
    assert (weights >= 0).all() and (weights <= 1).all()
    jaw, lip = weights[:, 0], weights[:, 1]
    opened = (jaw > 0.03) | (lip > 0.03)
    assert opened.mean() == pytest.approx(OPEN_MOUTH_SHARE, abs=0.04)
    assert (lip[opened] > 0.1).mean() > 0.8


def test_procedural_heads_smile_as_often() -> None:
    smiles = [
        (make_bald_procedural(np.random.default_rng(seed), "any")[0].label == TEETH).any()
        for seed in range(30)
    ]
    assert 0.1 < np.mean(smiles) < 0.6
