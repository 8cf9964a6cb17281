"""The exposure of one scan."""

import numpy as np
import pytest

from benchmarks.calibration import known_colours, model_colours
from skinnet import InputError
from skinnet.calibration._exposure import fit_exposure


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.5])
def test_a_known_exposure_is_recovered(factor: float) -> None:
    data = known_colours(np.eye(3) / factor, "paler", count=2000)
    assert fit_exposure(data, model_colours().reshape(-1, 3)) == pytest.approx(factor, rel=0.02)


def test_black_textures_and_colours_that_are_not_skin_are_refused() -> None:
    model = model_colours().reshape(-1, 3)
    with pytest.raises(InputError, match="has 0 colours that are not black"):
        fit_exposure(np.zeros((0, 3)), model)
    with pytest.raises(InputError, match="No exposure between"):
        fit_exposure(100 * model, model)
