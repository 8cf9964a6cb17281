import numpy as np
import pytest

from skinnet import Decomposition
from skinnet.inference import draw_panel
from skinnet.inference._tiles import round_up


def test_the_panel_shows_eight_pictures(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    picture = draw_panel(astronaut, decomposition)
    assert picture.shape == (806, 1290, 3) and picture.dtype == np.uint8
    tiles = [picture[y + 30 : y + 330, x : x + 300] for y in (18, 412) for x in (18, 336, 654, 972)]
    assert all(tile.std() > 10 for tile in tiles)


@pytest.mark.parametrize(
    ("value", "top"), [(0.14, 0.15), (0.15, 0.15), (0.9, 1), (1, 1), (0, 1e-6), (37, 40)]
)
def test_scales_end_at_round_numbers(value: float, top: float) -> None:
    assert round_up(float(value)) == pytest.approx(top)
