import numpy as np

from skinnet.images import Box
from skinnet.inference._editing import apply_gain, compute_gain, fade_edges


def test_gain_is_exactly_one_where_nothing_changes() -> None:
    colours = np.random.default_rng(0).random((6, 5, 3), np.float32)
    colours[0] = 0
    assert (compute_gain(colours, colours, np.zeros((6, 5), np.float32)) == 1).all()


def test_specular_reflection_is_not_tinted() -> None:
    crop = np.full((8, 8, 3), 200, np.uint8)
    ones = np.ones((4, 4), np.float32)
    gain = np.full((4, 4, 3), 0.5, np.float32)
    np.testing.assert_array_equal(apply_gain(crop, gain, ones, ones), crop)
    assert (apply_gain(crop, gain, 0 * ones, ones) < 150).all()


def test_edits_fade_towards_edges_inside_the_photograph() -> None:
    fade = fade_edges((50, 50), Box(0, 10, 60, 70), (100, 60))
    assert fade[25, 0] == fade[25, -1] == 1
    assert fade[0, 25] < 0.2 and fade[-1, 25] < 0.2
