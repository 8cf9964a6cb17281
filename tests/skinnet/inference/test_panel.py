from dataclasses import replace

import numpy as np

from skinnet import Decomposition
from skinnet.inference import draw_panel


def test_the_panel_shows_eight_pictures(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    picture = draw_panel(astronaut, decomposition)
    assert picture.shape == (842, 1290, 3) and picture.dtype == np.uint8
    tiles = [picture[y + 30 : y + 330, x : x + 300] for y in (18, 430) for x in (18, 336, 654, 972)]
    assert all(tile.std() > 10 for tile in tiles)


def test_the_scales_are_those_of_any_other_person(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    darker = replace(decomposition, melanin=3 * decomposition.melanin)
    panels = [draw_panel(astronaut, one) for one in (decomposition, darker)]
    rows = slice(18 + 330, 18 + 394)
    assert np.array_equal(*(panel[rows] for panel in panels))
