"""Scores of found changes."""

import numpy as np
import pytest

from benchmarks.changes import Found, measure, score
from skinnet.errors import InputError


def make_found(error: float, unchanged: bool, count: int = 40) -> list[Found | None]:
    """Changes that are found with a constant error, and one pair that is refused."""
    rng = np.random.default_rng(0)
    truths = rng.uniform(-0.7, 0.7, (count, 2))
    sd = np.full(2, 0.1)
    return [None, *(Found(truth, truth + error, sd, unchanged) for truth in truths)]


def test_scores_of_changes() -> None:
    found = score(make_found(0.1, False), make_found(0.0, True))
    assert found["melanin"]["r"] == pytest.approx(1)
    assert found["hemoglobin"]["rmse"] == pytest.approx(0.1)
    assert found["melanin"]["coverage"] == found["unchanged"] == found["noticed"] == 1
    assert found["refused"] == pytest.approx(1 / 41)
    assert score(make_found(0.2, True), make_found(0.0, False))["melanin"]["coverage"] == 0


def test_too_few_pairs_are_refused() -> None:
    with pytest.raises(InputError, match="3 pairs or more; got 2"):
        measure(2)
