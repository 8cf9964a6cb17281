"""Rows of a forest plot stand where the scale below them says."""

import numpy as np
import pytest

from skinnet.inference._colour_scales import PIGMENTS
from skinnet.inference._forest_plot import PlotRow, draw_forest_plot
from skinnet.inference._tiles import TILE

CAPTION = 30


def draw(*rows: PlotRow) -> np.ndarray:
    """Where the plot, without caption and scale, has ink."""
    tile = np.array(draw_forest_plot("melanin", "melanin", rows))
    return tile[CAPTION : CAPTION + TILE].min(-1) < 100


@pytest.mark.parametrize("mean", [0.01, 0.05, 0.4])
def test_the_interval_spans_its_fractions(mean: float) -> None:
    ink = draw(PlotRow("", mean, (0.8 * mean, 1.25 * mean)))
    columns = np.flatnonzero(ink.any(0))
    ends = PIGMENTS["melanin"].place(np.array([0.8, 1.25]) * mean).clip(0, 1) * (TILE - 1)
    assert (columns[0], columns[-1]) == pytest.approx(ends, abs=1.1)


def test_labels_do_not_lie_on_intervals() -> None:
    line = PlotRow("", 0.02, (0.001, 0.05))
    labelled = draw(line._replace(label="left cheek"))
    bare = draw(line)
    right = np.flatnonzero(bare.any(0))[-1]
    assert np.flatnonzero((labelled & ~bare).any(0))[0] > right


def test_hidden_rows_have_a_label_alone() -> None:
    ink = draw(PlotRow("nose", None, None))
    assert 0 < ink.any(0).sum() < 40


def test_many_rows_end_with_the_fused_one() -> None:
    rows = [PlotRow("", 0.02, (0.018, 0.022))] * 90
    ink = draw(*rows, PlotRow("", 0.3, (0.28, 0.33), 2))
    assert np.flatnonzero(ink[:, 200:].any(1)).size > 0
