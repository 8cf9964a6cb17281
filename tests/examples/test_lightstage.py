"""A few synthetic people through the whole pipeline, small."""

import pytest
from small_lightstage import Studied


@pytest.mark.slow
def test_people_become_models(studied: Studied) -> None:
    for folder in ("model", "model_effect"):
        assert (studied.folder / folder / "hybrid.npz").is_file()
    assert "transform: relative error" in studied.printed
    assert "f_blood: median of each person" in studied.printed
