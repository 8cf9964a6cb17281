"""Arithmetic of vectors."""

import numpy as np

from skinnet.mesh._vectors import normalise


def test_normalised_vectors_have_length_one_and_zero_stays_zero() -> None:
    vectors = np.array([[[3.0, 0, 4]], [[0.0, 0, 0]], [[0, 1e-100, 0]]])
    assert np.allclose(normalise(vectors), [[[0.6, 0, 0.8]], [[0, 0, 0]], [[0, 1, 0]]])
