"""Grids are found in perspective, with members missing and others beside them."""

import numpy as np
import pytest

from skinnet.inference._references.lattice import find_lattices
from skinnet.inference._references.patch_samples import apply_homography, sample_patches

HOMOGRAPHY = np.array([[90.0, -20, 200], [15, 80, 100], [4e-2, 2e-2, 1]])


def make_quads(columns: int = 6, rows: int = 4) -> np.ndarray:
    square = np.array([(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)])
    cells = np.array([(column, row) for row in range(rows) for column in range(columns)])
    return apply_homography(HOMOGRAPHY, cells[:, None] + square)


@pytest.mark.parametrize("missing", [(), (0,), (23, 7), (9, 10)])
def test_a_grid_is_found(missing: tuple[int, ...]) -> None:
    quads = np.delete(make_quads(), missing, 0)
    far = quads[:3] + 900
    turned = np.array([np.roll(quad, number, 0) for number, quad in enumerate(quads)])
    lattices = find_lattices(np.concatenate([turned, far]))
    assert len(lattices) == 1 and len(lattices[0].cells) == 24 - len(missing)
    extent = sorted((lattices[0].cells.max(0) + 1).tolist())
    assert extent == [4, 6]
    neighbours = lattices[0].cells[:, None] - lattices[0].cells
    apart = np.hypot(*np.moveaxis(lattices[0].centres[:, None] - lattices[0].centres, -1, 0))
    assert apart[np.abs(neighbours).sum(-1) == 1].max() < 110


def test_what_is_no_grid_is_none() -> None:
    assert find_lattices(np.zeros((0, 4, 2))) == []
    rng = np.random.default_rng(0)
    scattered = make_quads()[0] + rng.uniform(0, 3000, (12, 1, 2))
    assert find_lattices(scattered) == []


def test_patches_outside_are_not_a_number() -> None:
    picture = np.full((60, 60, 3), 0.25, np.float32)
    picture[:, :30] = 1
    cells = np.array([(0.0, 0), (1, 0), (2, 0)])
    found = sample_patches(picture, np.diag((30.0, 30.0, 1.0)), cells)
    assert np.isnan(found.linear[2]).all()
    np.testing.assert_allclose(found.linear[:2, 0], (1, 0.25), atol=1e-6)
    assert found.clipped.tolist()[:2] == [True, False] and found.spread[1] < 1e-6
