"""Edits with a name: what they do, and where that is from."""

from typing import NamedTuple


class AlbedoPreset(NamedTuple):
    """An edit with a name.

    Attributes:
        melanin: Factor of melanin.
        hemoglobin: Factor of hemoglobin.
        brush: A brush, as the command takes it; empty for none.
        source: Where its numbers are from.
    """

    melanin: float
    hemoglobin: float
    brush: str
    source: str


PRESETS = {
    "blush": AlbedoPreset(
        1.0, 2.0, "", "hemoglobin x 2: Alotaibi & Smith 2017, Figure 6, upper row"
    ),
    "tan": AlbedoPreset(1.5, 1.0, "", "melanin x 1.5: Alotaibi & Smith 2017, Figure 6, lower row"),
    "pallor": AlbedoPreset(
        1.0,
        0.5,
        "",
        "less blood, after Jimenez et al. 2010, A practical appearance model for dynamic facial "
        "color; the factor .5 is our choice",
    ),
    "vitiligo": AlbedoPreset(
        1.0,
        1.0,
        "patches:radius=10",
        "no melanin in patches, as melanocytes are lost there, and a lighter border: Brazzelli et "
        "al. 2008, The perilesional skin in vitiligo; hemoglobin x .5 for their chalk-white, "
        "places and cover are our choice, so paint a mask, or give --brush patches:... instead",
    ),
}
"""The edits by name."""
