"""Bilinear samples: exact at centres, linear between them, constant beyond the outermost."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skinnet.mesh._sampling import sample_bilinear


def test_pixels_keep_their_values_and_continue_beyond_the_edge() -> None:
    picture = np.arange(12, dtype=np.float64).reshape(3, 4, 1)
    row, column = np.mgrid[:3, :4]
    centres = np.stack([(column + 0.5) / 4, 1 - (row + 0.5) / 3], -1).reshape(-1, 2)
    assert np.allclose(sample_bilinear(picture, centres)[:, 0], np.arange(12))
    beyond = np.array([[-2.0, 3.0], [5.0, -1.0]])
    assert sample_bilinear(picture, beyond).ravel().tolist() == [0, 11]


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (3, 1)])
def test_a_picture_of_one_row_or_column_has_no_next_one(shape: tuple[int, int]) -> None:
    picture = np.full((*shape, 2), 7, np.uint8)
    uv = np.random.default_rng(0).uniform(-1, 2, (20, 2))
    assert (sample_bilinear(picture, uv) == 7).all()


@given(st.integers(0, 10**6), st.sampled_from([np.uint8, np.float32, np.float64]))
def test_samples_are_those_of_four_pixels(seed: int, kind: type) -> None:
    rng = np.random.default_rng(seed)
    height, width = rng.integers(2, 9, 2)
    picture = (255 * rng.random((height, width, 3))).astype(kind)
    uv = rng.random((30, 2))
    x = (uv[:, 0] * width - 0.5).clip(0, width - 1)
    y = ((1 - uv[:, 1]) * height - 0.5).clip(0, height - 1)
    left, top = x.astype(int).clip(max=width - 2), y.astype(int).clip(max=height - 2)
    expected = np.zeros((30, 3))
    for down in (0, 1):
        for right in (0, 1):
            weight = np.abs(1 - down - (y - top)) * np.abs(1 - right - (x - left))
            expected += weight[:, None] * picture[top + down, left + right]
    sampled = sample_bilinear(picture, uv)
    assert sampled.dtype == np.float32 and np.allclose(sampled, expected, rtol=1e-6)


def test_no_places_have_no_samples() -> None:
    assert sample_bilinear(np.ones((4, 4, 3)), np.zeros((0, 2))).shape == (0, 3)
