"""Lights by the names that photographers give them."""

import re

from skinnet.errors import InputError

_DAYLIGHT = re.compile(r"d(\d{2})|d?(\d{4,5})\s*k|d(\d{4,5})", re.ASCII)
_KELVIN = 4000.0, 25000.0

_C2_RATIO = 1.4388 / 1.438
"""CIE's two-digit names are older than today's value of c2 in Planck's law."""

_WORDS: dict[str, tuple[str, float | None]] = {
    "d": ("D", None),
    "daylight": ("D", None),
    "flash": ("D", 5500.0),
    "tungsten": ("A", None),
    "incandescent": ("A", None),
}
"""Lights of the model that words mean, and colour temperature."""

LIGHT_WORDS = tuple(word for word in _WORDS if len(word) > 1)


def find_light(name: str) -> tuple[str, float | None]:
    """Find the light of the model that a name means, and the temperature of daylight.

    Args:
        name: D65, D5500K or 5500K, a word such as flash, or the name of a light of the model.

    Returns:
        Name of the light, and its colour temperature in kelvin; None if the name has none.

    Raises:
        InputError: Daylight of a temperature that it does not have.
    """
    folded = name.strip().casefold()
    if found := _DAYLIGHT.fullmatch(folded):
        short, *others = found.groups()
        kelvin = 100 * float(short) * _C2_RATIO if short else float(others[0] or others[1])
        if not _KELVIN[0] <= kelvin <= _KELVIN[1]:
            raise InputError(
                f"Daylight has {_KELVIN[0]:,.0f} to {_KELVIN[1]:,.0f} K; got the light {name!r}. "
                "A lamp is tungsten, or one of the other lights by name."
            )
        return "D", kelvin
    return _WORDS.get(folded, (name.strip(), None))
