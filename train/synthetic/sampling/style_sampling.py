"""Random beards, make-up and colours of garments, for the variety `any`."""

from functools import cache

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from train.synthetic.scene import (
    BeardStyleParameters,
    CosmeticParameters,
    FaceParameters,
    GarmentParameters,
    SurroundingsParameters,
)
from train.synthetic.tensors import make_float_tensors

BEARD_SHARES = {"none": 0.56, "stubble": 0.18, "full": 0.1, "boxed": 0.05, "goatee": 0.05,
                "moustache": 0.06}  # fmt: skip
"""Shares of faces; all but `none` may have stubble around."""

_PARTS = {"none": (0, 0, 0, 0), "stubble": (0, 0, 0, 0), "full": (1, 1, 1, 1),
          "boxed": (1, 1, 1, 1), "goatee": (0, 1, 1, 1), "moustache": (0, 0, 1, 0)}  # fmt: skip
"""Cheeks, chin, moustache, and the bridge beside the mouth."""

STUBBLE_RANGE = (0.06, 0.42)
"""Opacity of stubble: less than half, so that stubble counts as skin."""

MAKE_UP_SHARE = 0.4
"""Share of the faces without beard that wear make-up of some kind."""

PAINT_SHARE, PLASTER_SHARE = 0.03, 0.06

OWN_SKIN_SHARE, SKIN_COLOUR_SHARE = 0.12, 0.14
"""Shares of garments that have the colour of the wearer's skin, or of some other skin."""

SKIN_COLOURS = ((0.62, 0.44, 0.34), (0.52, 0.33, 0.23), (0.40, 0.23, 0.14), (0.26, 0.13, 0.075),
                (0.13, 0.060, 0.035), (0.06, 0.030, 0.020))  # fmt: skip
"""Linear sRGB of light to dark skin, as beige and brown cloth, plasters and make-up have."""

_MASKS = ((0.35, 0.60, 0.75), (0.80, 0.82, 0.84), (0.015, 0.015, 0.017), (0.85, 0.50, 0.56))
"""Blue, white, black and pink."""

_Colour = Float[np.ndarray, "3"]


@cache
def make_no_style() -> tuple[BeardStyleParameters, CosmeticParameters, GarmentParameters]:
    """Make the style of the variety `mild`: zeros, and noise of one cell."""
    zero, colour, cell = torch.tensor(0.0), torch.zeros(3), torch.zeros(1, 1, 1)
    return (
        BeardStyleParameters(torch.zeros(4), zero, zero, zero, colour, cell, cell),
        CosmeticParameters(
            *(zero, zero, zero, colour, zero, colour, zero),
            *(zero, colour, cell, torch.zeros(5), zero, colour),
        ),
        GarmentParameters(
            torch.zeros(3, 2, 3),
            torch.zeros(3, 2, 3),
            torch.zeros(3, 3),
            torch.zeros(3, 1, 1),
            colour,
            colour,
            zero,
            zero,
        ),
    )


def add_style(face: FaceParameters, rng: np.random.Generator) -> FaceParameters:
    """Give a face a beard, make-up and garments of its own.

    Args:
        face: One face, without a batch axis.
        rng: Random numbers.

    Returns:
        The face, with 44 % of beards and stubble (`BEARD_SHARES`), and make-up on `MAKE_UP_SHARE`
        of the others.
    """
    kind = list(BEARD_SHARES)[rng.choice(len(BEARD_SHARES), p=list(BEARD_SHARES.values()))]
    style = _sample_beard(rng, kind, face.hair.colour.numpy())
    bare = torch.tensor(0.0)
    beard = face.hair.beard._replace(beard=bare, stubble=bare)
    made_up = bool(kind == "none" and rng.random() < MAKE_UP_SHARE)
    features = face.features._replace(**_sample_lipstick(rng, made_up))
    return face._replace(
        hair=face.hair._replace(beard=beard),
        features=features,
        beard_style=style,
        cosmetics=_sample_cosmetics(rng, made_up),
        garments=_sample_garments(rng),
    )


def vary_surroundings(
    surroundings: SurroundingsParameters, rng: np.random.Generator
) -> SurroundingsParameters:
    """Give one jacket, shirt and wall in seven each a colour that skin may have."""
    jacket, shirt, wall = rng.random(3) < SKIN_COLOUR_SHARE
    if jacket:
        surroundings = surroundings._replace(**make_float_tensors(jacket=_sample_skin_colour(rng)))
    if shirt:
        surroundings = surroundings._replace(**make_float_tensors(shirt=_sample_skin_colour(rng)))
    if wall:
        shade = surroundings.wall / surroundings.wall.mean((1, 2), keepdim=True)
        colour = torch.from_numpy(_sample_skin_colour(rng))
        surroundings = surroundings._replace(wall=shade * colour[:, None, None])
    return surroundings


def fit_long_beard(face: FaceParameters) -> FaceParameters:
    """Let a full beard grow around the long one of a mesh."""
    style = face.beard_style
    full = style._replace(
        parts=torch.ones(4),
        cheek_line=style.cheek_line.clamp(-0.02, 0.06),
        beard=style.beard.clamp_min(0.9),
    )
    bare = face.features.make_up * 0
    return face._replace(beard_style=full, features=face.features._replace(make_up=bare))


def _sample_beard(
    rng: np.random.Generator, kind: str, hair: Float[np.ndarray, "3"]
) -> BeardStyleParameters:
    """Of its own colour in one of three: grey, red, or darker than the hair."""
    colour = hair
    if rng.random() < 0.35:
        own = np.array(((0.35, 0.35, 0.35), (0.62, 0.61, 0.6), (0.2, 0.07, 0.025), hair * 0.6))
        colour = own[rng.integers(len(own))]
    full = rng.uniform(0.72, 1.0) if kind not in ("none", "stubble") else 0.0
    growing = kind == "stubble" or (kind != "none" and rng.random() < 0.6)
    low = {"full": 0.0, "boxed": -0.16}.get(kind, 0.0)
    return BeardStyleParameters(
        **make_float_tensors(
            parts=_PARTS[kind],
            cheek_line=low + rng.normal(0, 0.05),
            beard=full,
            stubble=rng.uniform(*STUBBLE_RANGE) if growing else 0.0,
            colour=colour.clip(0.004, 0.8),
            edge=rng.standard_normal((1, 28, 34), np.float32),
            hairs=rng.standard_normal((1, 84, 208), np.float32),
        )
    )


def _sample_lipstick(rng: np.random.Generator, made_up: bool) -> dict[str, Tensor]:
    """Sample lipstick on two of three made-up faces, mostly red, else of any colour."""
    red = np.array([0.35, 0.05, 0.07]) * np.exp(rng.normal(0, 0.5, 3))
    colour = red if rng.random() < 0.6 else _sample_hue(rng)
    worn = made_up and rng.random() < 0.65
    return make_float_tensors(
        make_up=rng.uniform(0.25, 0.95) if worn else 0.0, lipstick=colour.clip(0.01, 0.8)
    )


def _sample_cosmetics(rng: np.random.Generator, made_up: bool) -> CosmeticParameters:
    blush = np.array([0.55, 0.16, 0.14]) * np.exp(rng.normal(0, 0.25, 3))
    shadow = _sample_hue(rng) if rng.random() < 0.5 else np.full(3, rng.uniform(0.01, 0.15))

    def sample_opacity(share: float, low: float, high: float) -> float:
        worn, opacity = rng.random() < share, rng.uniform(low, high)
        return float(opacity) if worn and made_up else 0.0

    plaster = _sample_skin_colour(rng) if rng.random() < 0.7 else _sample_colour(rng)
    length = rng.uniform(0.1, 0.22)
    painted, hurt = rng.random() < PAINT_SHARE, rng.random() < PLASTER_SHARE
    return CosmeticParameters(
        **make_float_tensors(
            foundation=sample_opacity(0.7, 0.3, 0.9),
            foundation_tone=rng.normal(0, 0.15),
            blush=sample_opacity(0.5, 0.08, 0.4),
            blush_colour=blush.clip(0, 1),
            eye_shadow=sample_opacity(0.5, 0.15, 0.8),
            eye_shadow_colour=shadow,
            eyeliner=sample_opacity(0.5, 0.4, 0.95),
            paint=rng.uniform(0.6, 0.97) * painted,
            paint_colour=_sample_hue(rng),
            paint_noise=rng.normal(0, 1, (1, 10, 12)),
            plaster=(*rng.uniform((-0.9, -0.9), (0.9, 0.6)), rng.uniform(0, np.pi), length,
                     length * rng.uniform(0.28, 0.45)),
            plaster_opacity=0.97 * hurt,
            plaster_colour=plaster,
        )
    )  # fmt: skip


def _sample_garments(rng: np.random.Generator) -> GarmentParameters:
    colours = np.stack([[_sample_cloth(rng, mask) for _ in range(2)] for mask in (0, 1, 0)])
    plain = rng.random(3) < (0.5, 0.75, 0.4)
    amounts = rng.dirichlet((0.5, 0.5, 0.5), 3) * ~plain[:, None]
    # Lines of two directions, from wide stripes to narrow ones.
    rate = np.exp(rng.uniform(np.log(6), np.log(60), (3, 2)))
    angle = rng.choice([0, np.pi / 2, rng.uniform(0, np.pi)], (3, 1)) + [[0, np.pi / 2]]
    waves = np.stack([rate * np.cos(angle), rate * np.sin(angle), 6.28 * rng.random((3, 2))], -1)
    tint = _sample_hue(rng) if rng.random() < 0.4 else np.ones(3)
    mirror = rng.uniform(0.3, 0.9) if rng.random() < 0.3 else rng.uniform(0.0, 0.08)
    return GarmentParameters(
        **make_float_tensors(
            colours=colours,
            waves=waves,
            amounts=amounts,
            noise=rng.normal(0, 1, (3, 20, 20)),
            own_skin=rng.random(3) < OWN_SKIN_SHARE,
            lens=tint * np.exp(rng.uniform(np.log(0.006), np.log(0.06))),
            mirror=mirror,
            reflection=rng.choice([0.0, 0.5], p=(0.4, 0.6)) * rng.random() ** 2,
        )
    )


def _sample_cloth(rng: np.random.Generator, mask: int) -> _Colour:
    """Sample a colour of cloth: half of the masks are blue, white, black or pink."""
    if mask and rng.random() < 0.65:
        one = np.array(_MASKS[rng.choice(len(_MASKS), p=(0.4, 0.3, 0.24, 0.06))])
        return np.asarray((one * np.exp(rng.normal(0, 0.12, 3))).clip(0.01, 0.9))
    return _sample_colour(rng)


def _sample_colour(rng: np.random.Generator) -> _Colour:
    if rng.random() < SKIN_COLOUR_SHARE / (1 - OWN_SKIN_SHARE):
        return _sample_skin_colour(rng)
    if rng.random() < 0.45:
        grey = np.exp(rng.uniform(np.log(0.012), np.log(0.85)))
        return np.asarray((grey * np.exp(rng.normal(0, 0.05, 3))).clip(0.01, 0.9))
    return _sample_hue(rng)


def _sample_skin_colour(rng: np.random.Generator) -> _Colour:
    colour = np.array(SKIN_COLOURS[rng.integers(len(SKIN_COLOURS))])
    return np.asarray(
        (colour * np.exp(rng.normal(0, 0.12) + rng.normal(0, 0.06, 3))).clip(0.01, 0.9)
    )


def _sample_hue(rng: np.random.Generator) -> _Colour:
    """Sample a colour of any hue, pale to saturated, dark to light."""
    hue, saturation = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 1.6)
    light = np.exp(rng.uniform(np.log(0.03), np.log(0.5)))
    tint = np.cos(hue - 2 * np.pi / 3 * np.arange(3))
    return np.asarray((light * np.exp(saturation * tint)).clip(0.006, 0.9))
