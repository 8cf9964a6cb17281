"""Brushes over texture space: freckles, moles, flush, tan lines and patches without melanin."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32
from scipy.special import ndtri

from skinnet.errors import InputError
from skinnet.inference._command.nearest import suggest

_MAX_COUNT = 20_000
_NODES = 256
"""Nodes of noise along each axis, after which it repeats."""

_SLOPE = 2.7
"""Slope of the noise of patches, times their size."""

_HALO, _FAINT = 3.0, 0.25
"""Width of the outer border of patches over that of the inner, and its share of their strength."""

_PLACE = {"u": 0.5, "v": 0.5}
_DISC = {**_PLACE, "radius": 0.75, "seed": 0.0}
_USUAL: dict[str, dict[str, float]] = {
    "freckles": {**_DISC, "count": 400, "size": 0.004, "strength": 1.7},
    "moles": {**_DISC, "count": 6, "size": 0.007, "strength": 4.0},
    "flush": {**_DISC, "strength": 1.8, "radius": 0.1},
    "tan-line": {**_PLACE, "width": 0.05, "angle": 0.0, "strength": 1.6, "soft": 0.004},
    "patches": {
        **_DISC,
        "cover": 0.3,
        "size": 0.15,
        "strength": 0.0,
        "hemoglobin": 0.5,
        "soft": 0.03,
    },
}
_LIMITS = {
    "count": (1, _MAX_COUNT),
    "size": (1e-5, 1),
    "strength": (0, 10),
    "hemoglobin": (0, 10),
    "radius": (1e-4, 10),
    "width": (1e-4, 1),
    "angle": (-360, 360),
    "soft": (1e-5, 1),
    "cover": (0, 1),
    "u": (0, 10),
    "v": (0, 100),
    "seed": (0, 2**31),
}

BRUSHES = tuple(_USUAL)
"""Names of the brushes."""


class Factors(NamedTuple):
    """Factors of both fractions at the texels of a strip."""

    melanin: Float32[np.ndarray, "rows columns"]
    hemoglobin: Float32[np.ndarray, "rows columns"]


@dataclass(frozen=True)
class Brush:
    """A brush with its parameters, in units of texture space: a texture is 1 wide and 1 high.

    Args:
        name: One of `BRUSHES`.
        values: Its parameters; `u` to the right and `v` upwards from the lower left corner, `seed`
            of its random numbers.
    """

    name: str
    values: dict[str, float]

    def paint(
        self, u: Float[np.ndarray, "columns"], v: Float[np.ndarray, "rows"]
    ) -> Float32[np.ndarray, "rows columns"]:
        """Compute how much of the brush is on each texel, in [0, 1]."""
        return _PAINTERS[self.name](self.values, u, v)

    def compute_factors(
        self, u: Float[np.ndarray, "columns"], v: Float[np.ndarray, "rows"]
    ) -> Factors:
        """Compute the factors of melanin and hemoglobin."""
        painted = self.paint(u, v)
        factor = _mix(self.values["strength"], painted)
        other = _mix(self.values.get("hemoglobin", 1.0), painted)
        return Factors(other, factor) if self.name == "flush" else Factors(factor, other)


def parse_brush(word: str) -> Brush:
    """Parse NAME or NAME:KEY=VALUE,KEY=VALUE, such as freckles:count=300,u=0.5,v=0.6,radius=0.2.

    Raises:
        InputError: A name, a parameter or a value is none.
    """
    name, _, rest = word.partition(":")
    if name not in _USUAL:
        known = ", ".join(BRUSHES)
        raise InputError(f"There is no brush {name!r}; known are {known}.{suggest(name, BRUSHES)}")
    values = dict(_USUAL[name])
    for part in filter(None, rest.split(",")):
        key, equals, text = part.partition("=")
        if key not in values or not equals:
            raise InputError(
                f"The brush {name} takes {', '.join(values)}, as in {name}:u=0.5,v=0.6; got "
                f"{part!r}.{suggest(key, values)}"
            )
        values[key] = _read_number(name, key, text)
    return Brush(name, values)


def _read_number(name: str, key: str, text: str) -> float:
    low, high = _LIMITS[key]
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not low <= value <= high:
        raise InputError(f"{key} of the brush {name} is {low:g} to {high:g}; got {text}.")
    return value


def _mix(factor: float, share: Float32[np.ndarray, "r c"]) -> Float32[np.ndarray, "r c"]:
    """Mix a factor with 1 by its root: a colour is nearly linear in the root of a fraction."""
    return (1 + np.float32(np.sqrt(factor) - 1) * share) ** 2


def _fade(values: dict[str, float], u: np.ndarray, v: np.ndarray) -> Float32[np.ndarray, "r c"]:
    """Weight of the place: 1 at its centre, 0 from its radius on."""
    squared = (u - values["u"]) ** 2 + (v[:, None] - values["v"]) ** 2
    return np.asarray((1 - squared / values["radius"] ** 2).clip(0, 1), np.float32)


def _step(x: np.ndarray) -> Float32[np.ndarray, "*shape"]:
    """Smooth step from 0 at 0 to 1 at 1."""
    x = x.clip(0, 1)
    return np.asarray(x * x * (3 - 2 * x), np.float32)


class _Spot(NamedTuple):
    u: float
    v: float
    radius: float
    weight: float
    waves: np.ndarray


def _list_spots(values: dict[str, float], spread: float) -> Iterator[_Spot]:
    """Spots at random places, whose density falls evenly from the centre to 0 at the radius."""
    rng = np.random.default_rng(int(values["seed"]))
    for _ in range(int(values["count"])):
        angle, distance = rng.uniform(0, 2 * np.pi), np.sqrt(1 - np.sqrt(rng.uniform()))
        reach = values["radius"] * distance
        radius = 0.5 * values["size"] * np.exp(spread * rng.normal())
        waves, weight = rng.normal(size=(2, 3)) * [[0.08, 0.05, 0.03]], rng.uniform(0.5, 1)
        place = values["u"] + reach * np.cos(angle), values["v"] + reach * np.sin(angle)
        yield _Spot(*place, radius, weight, waves)


def _paint_spots(
    values: dict[str, float], u: np.ndarray, v: np.ndarray, spread: float, edge: float
) -> Float32[np.ndarray, "rows columns"]:
    """Spots with uneven outlines, whose `edge` is soft over this share of their radius."""
    painted = np.zeros((len(v), len(u)), np.float32)
    down = -v  # rows go down, and searchsorted wants ascending numbers
    for spot in _list_spots(values, spread):
        reach = 1.6 * spot.radius
        columns = slice(*np.searchsorted(u, (spot.u - reach, spot.u + reach)))
        rows = slice(*np.searchsorted(down, (-spot.v - reach, -spot.v + reach)))
        du, dv = u[columns] - spot.u, v[rows, None] - spot.v
        if du.size and dv.size:
            shape = _draw_spot(spot, du, dv, edge) * np.float32(spot.weight)
            np.maximum(painted[rows, columns], shape, out=painted[rows, columns])
    return painted


def _draw_spot(
    spot: _Spot, du: np.ndarray, dv: np.ndarray, edge: float
) -> Float32[np.ndarray, "rows columns"]:
    angle = np.arctan2(dv, du)
    outline = np.ones_like(angle)
    for k, (cosine, sine) in enumerate(spot.waves.T, start=2):
        outline += cosine * np.cos(k * angle) + sine * np.sin(k * angle)
    distance = np.hypot(du, dv) / (spot.radius * outline.clip(0.5, 1.5))
    return _step((1 + edge / 2 - distance) / edge)


def _sample_noise(
    seed: float, size: float, u: np.ndarray, v: np.ndarray, octaves: int = 4
) -> Float32[np.ndarray, "rows columns"]:
    """Smooth noise of mean 0 and deviation of about 1, with features of a size.

    Cubic B-splines over random nodes show no direction of their grid.
    """
    total = np.zeros((len(v), len(u)))
    for octave in range(octaves):
        table = np.random.default_rng((int(seed), octave)).normal(size=(_NODES, _NODES))
        columns, rows = (_weigh_nodes(axis * 2**octave / size) for axis in (u, v))
        strips = sum(weight[:, None] * table[node] for node, weight in rows)
        total += sum(weight * strips[:, node] for node, weight in columns) * 0.55**octave
    return np.asarray(total * 1.75, np.float32)


def _weigh_nodes(x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Numbers of the four nodes about each place, and their weights."""
    before = np.floor(x).astype(np.int64)
    t = x - before
    weights = (
        (1 - t) ** 3 / 6,
        (3 * t**3 - 6 * t**2 + 4) / 6,
        (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6,
        t**3 / 6,
    )
    return [((before + k - 1) % _NODES, weight) for k, weight in enumerate(weights)]


def _paint_freckles(
    values: dict[str, float], u: np.ndarray, v: np.ndarray
) -> Float32[np.ndarray, "rows columns"]:
    return _paint_spots(values, u, v, 0.35, 1.2)


def _paint_moles(
    values: dict[str, float], u: np.ndarray, v: np.ndarray
) -> Float32[np.ndarray, "rows columns"]:
    return _paint_spots(values, u, v, 0.25, 0.45)


def _paint_flush(
    values: dict[str, float], u: np.ndarray, v: np.ndarray
) -> Float32[np.ndarray, "rows columns"]:
    noise = _sample_noise(values["seed"], values["radius"] / 3, u, v)
    return np.asarray(_step(1.2 * _fade(values, u, v)) * (0.85 + 0.15 * noise).clip(0.4, 1))


def _paint_tan_line(
    values: dict[str, float], u: np.ndarray, v: np.ndarray
) -> Float32[np.ndarray, "rows columns"]:
    """All but a band through the place is tanned; 0 degrees is a band to the right."""
    angle = np.deg2rad(values["angle"])
    across = (v[:, None] - values["v"]) * np.cos(angle) - (u - values["u"]) * np.sin(angle)
    return _step((np.abs(across) - values["width"] / 2) / values["soft"] + 0.5)


def _paint_patches(
    values: dict[str, float], u: np.ndarray, v: np.ndarray
) -> Float32[np.ndarray, "rows columns"]:
    """Patches with a border of the width `soft`, within a wider one where skin is a little lighter.

    The wider border is that of Brazzelli et al. 2008, The perilesional skin in vitiligo.
    """
    noise = _sample_noise(values["seed"], values["size"], u, v, octaves=3)
    level = -ndtri(values["cover"])  # the share of a normal distribution above it is the cover
    border = _SLOPE * values["soft"] / values["size"]
    place = _fade(values, u, v)
    height = noise - level - 4 * (1 - _step(2 * place))  # patches shrink towards the radius
    inner, outer = (_step(height / wide + 0.5) for wide in (border, _HALO * border))
    mixed = np.float32(1 - _FAINT) * inner + np.float32(_FAINT) * outer
    return np.asarray(mixed * (place > 0), np.float32)


_PAINTERS: dict[
    str,
    Callable[[dict[str, float], np.ndarray, np.ndarray], Float32[np.ndarray, "rows columns"]],
] = {
    "freckles": _paint_freckles,
    "moles": _paint_moles,
    "flush": _paint_flush,
    "tan-line": _paint_tan_line,
    "patches": _paint_patches,
}
