"""Settings of a fit that are out of range are refused in words."""

from typing import Any

import pytest

from skinnet.errors import InputError
from skinnet.shape.fit_settings import FitSettings


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"kept": 0.0}, "kept is a share"),
        ({"kept": 80.0}, "kept is a share"),
        ({"sliding": 2.0}, "sliding is a weight"),
        ({"map_weight": -1.0}, "map_weight is 0 or more"),
        ({"stages": ()}, "stages is empty"),
    ],
)
def test_settings_out_of_range_are_refused(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        FitSettings(**settings)
