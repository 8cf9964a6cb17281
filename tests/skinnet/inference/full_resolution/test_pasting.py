import numpy as np

from skinnet.images import Box
from skinnet.inference.full_resolution._layers import Layers
from skinnet.inference.full_resolution._pasting import paste_layers

PHOTO = np.full((4, 6, 3), 90, np.uint8)


def make_layers(height: int, width: int) -> Layers:
    plane, colours = np.ones((height, width), np.float32), np.ones((height, width, 3), np.float32)
    return Layers(*[plane] * 5, colours, np.full((height, width, 3), 200, np.uint8))


def test_where_nothing_was_read_the_photograph_stays() -> None:
    inside = np.array([[True, False], [True, True]])
    pasted = paste_layers(make_layers(2, 2), PHOTO, Box(3, 1, 5, 3), inside)
    read = np.zeros((4, 6), bool)
    read[1:3, 3:5] = inside
    np.testing.assert_array_equal(pasted["melanin"], read)
    np.testing.assert_array_equal(pasted["offset"], np.repeat(read[..., None], 3, 2))
    np.testing.assert_array_equal(pasted["reconstruction"][..., 0], np.where(read, 200, 90))


def test_a_whole_photograph_is_not_copied() -> None:
    layers = make_layers(4, 6)
    pasted = paste_layers(layers, PHOTO, Box(0, 0, 6, 4), np.ones((4, 6), bool))
    assert pasted["melanin"] is layers.melanin
