"""What docs/misprints.md says of the paper's tables, computed."""

import re
from pathlib import Path

from skinnet.physics import WAVELENGTHS, SkinOptics

TEXT = (Path(__file__).parents[1] / "docs" / "misprints.md").read_text(encoding="utf-8")
PAPER, PRINTED = SkinOptics.preset("paper"), SkinOptics.preset("printed")


def test_eumelanin_is_an_absorption_already() -> None:
    ratio = PRINTED.eps_eum / (PAPER.eps_eum * PAPER.c_eum)
    stated = re.search(r"agrees with the law within ([\d.]+) to (\d*\.\d+)", TEXT)
    assert stated is not None
    assert [f"{ratio.min():.2f}", f"{ratio.max():.2f}"] == list(stated.groups())


def test_the_exponent_of_pheomelanin_is_wrong() -> None:
    measured = PAPER.eps_phm * PAPER.c_phm
    ratio = 2.9e15 * WAVELENGTHS**-4.75 / measured
    stated = re.search(r"which is (\d+) to (\d+) times the measured\s+extinction times 12", TEXT)
    assert stated is not None
    assert [f"{ratio.min():.0f}", f"{ratio.max():.0f}"] == list(stated.groups())
    thousandths = 1000 * PRINTED.eps_phm / PAPER.eps_phm
    assert "about a thousandth" in TEXT and 0.8 < thousandths.min() < thousandths.max() < 1.3
