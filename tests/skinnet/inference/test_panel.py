from dataclasses import replace

import numpy as np

from skinnet import Decomposition
from skinnet.inference import draw_panel


def test_the_panel_shows_ten_pictures(decomposition: Decomposition, astronaut: np.ndarray) -> None:
    picture = draw_panel(astronaut, decomposition)
    assert picture.shape == (842, 1608, 3) and picture.dtype == np.uint8
    corners = [(y, x) for y in (18, 430) for x in (18, 336, 654, 972, 1290)]
    tiles = [picture[y + 30 : y + 330, x : x + 300] for y, x in corners]
    assert all(tile.std() > 10 for tile in tiles)


def test_the_panel_shows_how_sure_the_pigments_are(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    sure = decomposition.uncertainty
    more = sure._replace(melanin=2 * sure.melanin, face=(2 * sure.face[0], sure.face[1]))
    panels = [
        draw_panel(astronaut, replace(decomposition, uncertainty=each)) for each in (sure, more)
    ]
    changed = (panels[0] != panels[1]).any(-1)
    caption, tile = np.s_[18:48, 336:636], np.s_[460:760, 336:636]
    assert changed[caption].any() and changed[tile].any()
    changed[caption] = changed[tile] = changed[430:460, 336:636] = False
    assert not changed.any()


def test_the_scales_are_those_of_any_other_person(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    darker = replace(decomposition, melanin=3 * decomposition.melanin)
    panels = [draw_panel(astronaut, one) for one in (decomposition, darker)]
    rows = slice(18 + 330, 18 + 394)
    assert np.array_equal(*(panel[rows] for panel in panels))
