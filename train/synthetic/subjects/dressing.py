"""Completes a bald head of the variety `any`: hair that fits under a hat, and all that is worn."""

import numpy as np
from jaxtyping import Float

from train.synthetic.bodies.body import Neck, make_bust
from train.synthetic.bodies.hair import Haircut, make_cap, make_long_hair, sample_haircut
from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, select
from train.synthetic.bodies.shell import HeadSurface
from train.synthetic.garments.glasses import make_any_glasses
from train.synthetic.garments.wardrobe import HOODS, Wardrobe, make_garments, sample_wardrobe
from train.synthetic.labels import EYE, SKIN

_FLAT = 0.035
"""Largest volume of hair under a hat, in half heads."""


def dress_head(bald: LabelledMesh, neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Put hair, shoulders and what is worn on a bald head.

    Args:
        bald: Skin, eyes and mouth.
        neck: Where its neck ends.
        rng: Random numbers.

    Returns:
        The whole head, dressed with the shares of `train.synthetic.garments.wardrobe`.
    """
    skin, wardrobe = select(bald, SKIN), sample_wardrobe(rng)
    bust = make_bust(neck, rng, wardrobe.neckwear == "roll-neck")
    parts = [bald, bust, *_make_hair(skin, wardrobe, rng)]
    parts += make_garments(wardrobe, HeadSurface(skin), neck, rng)
    if wardrobe.glasses:
        parts.append(make_any_glasses(skin, find_eyes(select(bald, EYE)), rng))
    return join(parts)


def find_eyes(eyes: LabelledMesh) -> Float[np.ndarray, "2 3"]:
    """Find the foremost points of both eyes."""
    sides = [eyes.vertices[sign * eyes.vertices[:, 0] > 0] for sign in (1, -1)]
    return np.stack([(one.min(0) + one.max(0)) / 2 * [1, 1, 0] + [0, 0, one[:, 2].max()]
                     for one in sides])  # fmt: skip


def _make_hair(
    skin: LabelledMesh, wardrobe: Wardrobe, rng: np.random.Generator
) -> list[LabelledMesh]:
    cut = _flatten(sample_haircut(rng), wardrobe.headwear)
    if wardrobe.headwear in HOODS:
        return []
    parts = [make_cap(skin, cut, rng)]
    if cut.length and wardrobe.headwear != "turban":
        parts.append(make_long_hair(skin, cut, rng))
    return parts


def _flatten(cut: Haircut, headwear: str) -> Haircut:
    if headwear == "none":
        return cut
    return cut._replace(volume=min(cut.volume, _FLAT), fringe=0.0)
