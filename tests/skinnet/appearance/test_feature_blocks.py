"""Blocks of features have a bounded size."""

import numpy as np
import pytest

from skinnet.appearance._feature_blocks import ArrayBlocks, compute_block_width
from skinnet.errors import InputError


def rows(subjects: int = 6, texels: int = 40, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    steps = rng.standard_normal((subjects, 2 * texels)) * np.geomspace(1, 0.1, 2 * texels)
    return (5 + steps).astype(np.float32)


def test_a_thousand_subjects_take_blocks_of_bounded_size() -> None:
    for subjects in (25, 1000):
        assert 0.9 * 2**27 < 4 * subjects * 5 * compute_block_width(subjects, 5) <= 2**27


def test_features_are_split_into_equal_blocks() -> None:
    with pytest.raises(InputError, match="80 features cannot be split into 3"):
        ArrayBlocks(rows(), 3)
