"""What a head of the variety `any` wears."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.bodies.long_beards import make_long_beard
from train.synthetic.bodies.shell import HeadSurface
from train.synthetic.garments.face_masks import make_face_mask
from train.synthetic.garments.headwear import (
    make_balaclava,
    make_beanie,
    make_brimmed_hat,
    make_cap,
    make_hard_hat,
    make_headscarf,
    make_turban,
    make_veil,
)
from train.synthetic.garments.neckwear import make_collar, make_roll_neck, make_scarf

HEADWEAR_SHARES = {
    "none": 0.62, "beanie": 0.05, "cap": 0.07, "brimmed hat": 0.05, "hard hat": 0.03,
    "turban": 0.04, "headscarf": 0.07, "veil": 0.04, "balaclava": 0.03,
}  # fmt: skip

HOODS = ("headscarf", "veil", "balaclava")
"""What hides all hair and the neck."""

FACE_MASK_SHARE = 0.17
"""Of heads without veil and balaclava."""

GLASSES_SHARE = 0.25

NECKWEAR_SHARES = {"none": 0.58, "collar": 0.2, "roll-neck": 0.09, "scarf": 0.13}
"""Of heads without a hood."""

LONG_BEARD_SHARE = 0.06
"""Of heads with neither a hood nor a mask; their scenes paint a full beard around it."""

_Crown = Callable[[HeadSurface, np.random.Generator], LabelledMesh]
_Hood = Callable[[HeadSurface, Neck, np.random.Generator], LabelledMesh]
_Neckwear = Callable[[Neck, np.random.Generator], LabelledMesh]

_CROWNS: dict[str, _Crown] = {
    "beanie": make_beanie,
    "cap": make_cap,
    "brimmed hat": make_brimmed_hat,
    "hard hat": make_hard_hat,
    "turban": make_turban,
}
_HOODS: dict[str, _Hood] = {
    "headscarf": make_headscarf,
    "veil": make_veil,
    "balaclava": make_balaclava,
}
_NECKWEAR: dict[str, _Neckwear] = {
    "collar": make_collar,
    "roll-neck": make_roll_neck,
    "scarf": make_scarf,
}


class Wardrobe(NamedTuple):
    """Names of headwear and neckwear, and whether there are glasses, a mask and a long beard."""

    headwear: str
    neckwear: str
    glasses: bool
    face_mask: bool
    long_beard: bool


def sample_wardrobe(rng: np.random.Generator) -> Wardrobe:
    """Sample what a head wears, with the shares of this module."""
    headwear = _choose(HEADWEAR_SHARES, rng)
    neckwear = _choose(NECKWEAR_SHARES, rng)
    glasses, face_mask = rng.random() < GLASSES_SHARE, rng.random() < FACE_MASK_SHARE
    hood = headwear in HOODS
    masked = bool(face_mask and headwear not in ("veil", "balaclava"))
    bearded = bool(rng.random() < LONG_BEARD_SHARE and not (hood or masked))
    return Wardrobe(headwear, "none" if hood else neckwear, bool(glasses), masked, bearded)


def make_garments(
    wardrobe: Wardrobe, surface: HeadSurface, neck: Neck, rng: np.random.Generator
) -> list[LabelledMesh]:
    """Make headwear, face mask and neckwear.

    Args:
        wardrobe: What is worn.
        surface: The head's skin.
        neck: Where the neck ends.
        rng: Random numbers.

    Returns:
        One mesh a garment.
    """
    parts = []
    if wardrobe.headwear in _CROWNS:
        parts.append(_CROWNS[wardrobe.headwear](surface, rng))
    if wardrobe.headwear in _HOODS:
        parts.append(_HOODS[wardrobe.headwear](surface, neck, rng))
    if wardrobe.face_mask:
        parts.append(make_face_mask(surface, rng))
    if wardrobe.long_beard:
        parts.append(make_long_beard(surface, rng))
    if wardrobe.neckwear in _NECKWEAR:
        parts.append(_NECKWEAR[wardrobe.neckwear](neck, rng))
    return parts


def _choose(shares: dict[str, float], rng: np.random.Generator) -> str:
    names = list(shares)
    return names[rng.choice(len(names), p=list(shares.values()))]
