"""What fractions skin usually has, and a reading on the console with its unit and them."""

from collections.abc import Sequence

from skinnet.inference._uncertainty import LEVEL

_OPTICS = "measured"
"""Preset of the skin's constants to which the usual fractions belong."""

USUAL = {"melanin": (0.013, 0.43), "hemoglobin": (0.02, 0.13)}
"""Fractions that skin usually has.

Those of melanin are published, from light skin (1.3 %) to the darkest (43 %); those of blood are
what 95 of 100 people have (`SkinPrior`).

Source:
    S. Jacques, Origins of tissue optical properties in the UVA, visible and NIR regions, 1996.
"""


def describe_reading(
    name: str, mean: float, interval: Sequence[float], optics: str | None = None
) -> str:
    """Describe the mean of a pigment in percent, with its interval and what is usual.

    Args:
        name: "melanin" or "hemoglobin".
        mean: The mean fraction.
        interval: Both ends of its 90 % interval.
        optics: Preset to which the fractions belong; of others than `measured` what is usual is not
            known, and is left out.

    Example:
        >>> describe_reading("melanin", 0.033, (0.021, 0.053), "measured")
        'melanin 3.3 % (90 %: 2.1 to 5.3; usual 1.3 to 43 %)'
    """
    low, high = (_percent(end) for end in interval)
    usual = f"; usual {describe_usual(name)}" if optics == _OPTICS else " %"
    return f"{name} {_percent(mean)} % ({100 * LEVEL:.0f} %: {low} to {high}{usual})"


def describe_usual(name: str) -> str:
    """Describe what fractions of a pigment are usual, in percent."""
    low, high = (_percent(end) for end in USUAL[name])
    return f"{low} to {high} %"


def _percent(fraction: float) -> str:
    return f"{100 * fraction:.2g}"
