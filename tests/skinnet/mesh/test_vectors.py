"""Arithmetic of vectors."""

import numpy as np

from skinnet.mesh._vectors import measure_edges, normalise


def test_normalised_vectors_have_length_one_and_zero_stays_zero() -> None:
    vectors = np.array([[[3.0, 0, 4]], [[0.0, 0, 0]], [[0, 1e-100, 0]]])
    assert np.allclose(normalise(vectors), [[[0.6, 0, 0.8]], [[0, 0, 0]], [[0, 1, 0]]])


def test_edges_of_closed_curves_include_the_last_one() -> None:
    triangle = np.array([[0.0, 0], [3, 0], [3, 4]])
    assert np.allclose(measure_edges(triangle), [3, 4, 5])
    assert np.allclose(measure_edges(np.stack([triangle, 2 * triangle])), [[3, 4, 5], [6, 8, 10]])
