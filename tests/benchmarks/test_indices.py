"""Indices from pigments come near those of measured spectra."""

import pytest

from benchmarks import indices
from benchmarks.report import Results
from skinnet.inference._index_table import INDICES

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found() -> Results:
    return indices.measure()


def test_every_set_has_every_index(found: Results) -> None:
    assert set(found) == {"nist", "issa", "all", "held_out"}
    assert set(found["held_out"]) == {"nist", "issa", "all"}
    assert set(found["all"]) == {"count", *INDICES, "monk_tone"}
    assert found["all"]["count"] == found["held_out"]["all"]["count"] == 448
    assert sum(found["all"]["monk_tone"]["counts"].values()) == 448


def test_typology_angles_are_within_a_degree_and_a_half(found: Results) -> None:
    assert found["all"]["typology_angle"]["median"] < 1.5
    assert found["held_out"]["all"]["typology_angle"]["median"] < 1.5


def test_intervals_hold_what_they_promise(found: Results) -> None:
    for name in INDICES:
        assert 0.88 < found["held_out"]["all"][name]["coverage"] < 0.97, name


def test_the_nearest_tone_is_that_of_the_spectrum(found: Results) -> None:
    tones = found["held_out"]["all"]["monk_tone"]
    assert tones["same"] > 0.85 and tones["near"] == 1
