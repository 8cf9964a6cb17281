"""The nearest tone of a public scale to a colour of skin."""

import csv
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray


def read_rows(name: str) -> list[list[str]]:
    """Read the rows of `tables/NAME.csv` below its heading; its first line has the source."""
    text = (files("skinnet.inference") / "tables" / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))[1:]


@cache
def load_monk_tones() -> NDArray[np.float64]:
    """Load L*a*b* [10, 3] of the tones of the Monk Skin Tone Scale, lightest first.

    Source:
        Monk, Ellis. "Monk Skin Tone Scale", 2019, https://skintone.google (CC BY 4.0).
    """
    from skimage.color import rgb2lab

    srgb = [list(bytes.fromhex(colour)) for _, colour in read_rows("monk_skin_tones")]
    lab: NDArray[np.float64] = rgb2lab(np.array(srgb, np.uint8)[None])[0].astype(np.float64)
    return lab


def compare_with_monk(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute CIEDE2000 between colours, L*a*b* [n, 3], and each tone: [n, 10]."""
    # Slow to import, and only summaries need it.
    from skimage.color import deltaE_ciede2000

    differences = deltaE_ciede2000(lab[:, None], load_monk_tones()[None])  # type: ignore[no-untyped-call]
    return np.asarray(differences)
