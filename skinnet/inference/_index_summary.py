"""Indices of skin with their intervals."""

from typing import Any, NamedTuple

_DECIMALS = 4


class Index(NamedTuple):
    """A number and how certain it is.

    Attributes:
        value: The number.
        sd: Its standard deviation.
        interval: Numbers between which the true one lies with the probability that was asked for.
    """

    value: float
    sd: float
    interval: tuple[float, float]

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        low, high = self.interval
        numbers = {"value": _round(self.value), "sd": _round(self.sd)}
        return {**numbers, "interval": [_round(low), _round(high)]}


class NearestTone(NamedTuple):
    """The tone of a scale whose colour is nearest to that of the skin under D65.

    It is a class of a colour, and not an identity: neither people who compare themselves with the
    scale nor annotators need choose the same.

    Attributes:
        value: Number of the tone, from 1, the lightest.
        interval: First and last tone that is nearest to a colour in the intervals.
        delta_e: CIEDE2000 between the skin and that tone; below 2 they look alike.
    """

    value: int
    interval: tuple[int, int]
    delta_e: float

    def to_json(self) -> dict[str, Any]:
        """The same as numbers for JSON."""
        delta_e = _round(self.delta_e)
        return {"value": self.value, "interval": list(self.interval), "delta_e": delta_e}


class SkinIndices(NamedTuple):
    """Numbers that people use for skin, each with its interval.

    They are those of the spectrum that is expected of skin with the pigments that were read, as a
    spectrophotometer measures it: specular reflection at the surface included.

    Attributes:
        l_star: Lightness L* of CIELAB under D65, for the observer of CIE 1931.
        a_star: a* of CIELAB.
        b_star: b* of CIELAB.
        typology_angle: Individual typology angle, atan2(L* - 50, b*) in degrees.
        melanin_index: 100 log10(1 / R) at 655 nm, as a DermaSpectrometer defines it.
        erythema_index: 100 log10(R at 655 nm / R at 568 nm), as a DermaSpectrometer defines it.
        typology_group: Group of the angle: very_light (above 55 degrees), light (41), intermediate
            (28), tan (10), brown (-30) or dark.
        monk_tone: Nearest tone of the Monk Skin Tone Scale by colour.
    """

    l_star: Index
    a_star: Index
    b_star: Index
    typology_angle: Index
    melanin_index: Index
    erythema_index: Index
    typology_group: str
    monk_tone: NearestTone

    def to_json(self) -> dict[str, Any]:
        """The same as numbers and words for JSON."""
        return {
            name: value if isinstance(value, str) else value.to_json()
            for name, value in self._asdict().items()
        }


def _round(number: float) -> float:
    return round(number, _DECIMALS)
