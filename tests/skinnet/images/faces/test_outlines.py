import numpy as np
import pytest

from skinnet.images import Box
from skinnet.images.faces._outlines import fill_outlines, measure_area, measure_depth

SQUARE = np.array([[2, 3], [12, 3], [12, 9], [2, 9]], np.float32)


def test_pixels_of_which_the_centre_is_inside_are_filled() -> None:
    patch = fill_outlines([SQUARE])
    assert patch.box == Box(2, 3, 12, 9)
    assert patch.inside.all()
    np.testing.assert_array_equal(patch.centres[0], (2.5, 3.5))
    np.testing.assert_array_equal(patch.centres[-1], (11.5, 8.5))


def test_holes_are_left_out() -> None:
    patch = fill_outlines([SQUARE], [SQUARE[[0, 0, 3, 3]] + [[0, 0], [4, 0], [4, 0], [0, 0]]])
    np.testing.assert_array_equal(patch.inside.any(0), [False] * 4 + [True] * 6)


@pytest.mark.parametrize(
    ("shift", "columns"), [((-5, 0), 7), ((0, 0), 10), ((10, 0), 8), ((40, 0), 0), ((-40, 0), 0)]
)
def test_a_patch_is_clipped_to_the_photograph(shift: tuple[int, int], columns: int) -> None:
    patch = fill_outlines([SQUARE + shift]).clip(20, 20)
    assert patch.inside.shape == (patch.box.height, patch.box.width) == (6, columns)
    assert np.zeros((20, 20))[patch.box.slices].shape == patch.inside.shape


def test_the_area_is_negative_if_corners_run_anticlockwise() -> None:
    assert measure_area(SQUARE) == 60
    assert measure_area(SQUARE[::-1]) == -60


def test_the_depth_is_the_distance_to_the_nearest_edge() -> None:
    points = np.array([[7, 6], [3, 6], [11.5, 8]])
    np.testing.assert_allclose(measure_depth(points, SQUARE), [3, 1, 0.5])
