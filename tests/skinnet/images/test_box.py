import numpy as np

from skinnet.images import Box


def test_a_box_selects_its_pixels() -> None:
    array = np.arange(48).reshape(6, 8)
    box = Box(1, 2, 4, 6)
    assert (box.width, box.height) == (3, 4)
    np.testing.assert_array_equal(array[box.slices], array[2:6, 1:4])
