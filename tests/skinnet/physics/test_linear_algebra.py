"""Inverses by cofactors are NumPy's."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics._linear_algebra import invert_3x3


@given(st.integers(0, 2**31), st.floats(0.1, 10))
def test_inverse_is_numpys(seed: int, scale: float) -> None:
    matrix = scale * np.random.default_rng(seed).normal(size=(4, 3, 3)) + 3 * scale * np.eye(3)
    assert invert_3x3(torch.tensor(matrix)).numpy() == pytest.approx(
        np.linalg.inv(matrix), rel=1e-6
    )
