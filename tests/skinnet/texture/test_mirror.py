"""Mirror images of vertices are found in a symmetric mesh."""

import numpy as np

from benchmarks.texture import make_face_mesh
from skinnet.texture._mirror import find_mirror_vertices

VERTICES, _ = make_face_mesh(24, 31)


def test_mirror_is_found_up_to_a_tolerance_or_not_at_all() -> None:
    mirror = find_mirror_vertices(
        VERTICES + np.random.default_rng(0).normal(0, 0.01, VERTICES.shape)
    )
    assert mirror is not None
    assert np.allclose(VERTICES[mirror], VERTICES * [-1, 1, 1], atol=1e-9)
    assert find_mirror_vertices(VERTICES + [3.0, 0, 0]) is None
