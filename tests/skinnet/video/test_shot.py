"""Shading of the regions of a shot."""

import numpy as np
import pytest

from skinnet.video._regions import NAMES
from skinnet.video._shot import _spread_shading


def test_exposure_is_no_shading_and_a_turn_is() -> None:
    exposure = np.full((len(NAMES), 3), 0.2)
    assert _spread_shading(exposure) == pytest.approx(0)
    turn = exposure + np.linspace(-0.1, 0.1, len(NAMES))[:, None]
    turn[2] = np.nan
    assert 0.05 < _spread_shading(turn) < 0.1
