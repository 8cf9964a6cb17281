"""What is said of faces of which single frames tell little."""

import numpy as np
import pytest

from skinnet.video._least_change import LeastChange
from skinnet.video._readings import QUANTILE, READ, make_blank
from skinnet.video._regions import FACE, NAMES


@pytest.mark.parametrize(
    ("percent", "sentence"),
    [(5.0, ""), (20.0, "below about 20 %"), (90.0, "cannot be read in this")],
)
def test_a_large_least_change_is_said(percent: float, sentence: str) -> None:
    least = LeastChange()
    sd = np.full(len(NAMES), np.log(1 + percent / 100) / QUANTILE)
    for number in range(3):
        blank = make_blank(number, float(number), 1, READ, len(NAMES))
        least.add(blank._replace(noise_sd=sd))
    notes = least.list_notes()
    assert sentence in " ".join(notes) and bool(notes) == bool(sentence)
    assert least.describe()[FACE] == round(percent / 100, 4)


def test_a_region_that_was_never_seen_has_none() -> None:
    assert LeastChange().describe()[FACE] is None
