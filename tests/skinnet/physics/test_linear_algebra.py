"""Inverses by cofactors are NumPy's, and each spectrum meets the matrix of its photograph."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics._linear_algebra import apply_matrix, invert_3x3


@given(st.integers(0, 2**31), st.floats(0.1, 10))
def test_inverse_is_numpys(seed: int, scale: float) -> None:
    matrix = scale * np.random.default_rng(seed).normal(size=(4, 3, 3)) + 3 * scale * np.eye(3)
    assert invert_3x3(torch.tensor(matrix)).numpy() == pytest.approx(
        np.linalg.inv(matrix), rel=1e-6
    )


@given(st.lists(st.integers(1, 3), max_size=2), st.lists(st.integers(1, 3), max_size=3))
def test_one_matrix_for_each_of_the_batch(batch: list[int], others: list[int]) -> None:
    rng = torch.Generator().manual_seed(0)
    matrix = torch.rand(*batch, 33, 3, generator=rng)
    reflectance = torch.rand(*batch, *others, 33, generator=rng)
    spread = matrix.reshape(*batch, *[1] * len(others), 33, 3)
    expected = (reflectance[..., None] * spread).sum(-2)
    assert torch.allclose(apply_matrix(reflectance, matrix), expected, atol=1e-5)
