"""Whole synthetic heads: bald ones, completed by hair, glasses and shoulders."""

from collections.abc import Mapping

import numpy as np

from train.synthetic.bodies.bald_ict import make_bald_ict
from train.synthetic.bodies.bald_procedural import make_bald_procedural
from train.synthetic.bodies.body import Neck, make_bust
from train.synthetic.bodies.hair import make_cap, make_long_hair, sample_haircut
from train.synthetic.bodies.ict_model import IctModel
from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, mirror, select
from train.synthetic.garments.glasses import make_glasses
from train.synthetic.labels import EYE, SKIN
from train.synthetic.subjects.dressing import dress_head, find_eyes
from train.synthetic.variety import Variety


def make_procedural_head(rng: np.random.Generator, variety: Variety = "mild") -> LabelledMesh:
    """Make a whole head of `skinnet.shape._procedural_head`."""
    return complete_head(*make_bald_procedural(rng, variety), rng, variety)


def make_ict_head(
    model: IctModel,
    rng: np.random.Generator,
    variety: Variety = "mild",
    expression: Mapping[str, float] | None = None,
) -> LabelledMesh:
    """Make a whole head of ICT-FaceKit with an expression and a gaze; half are mirrored."""
    bald, neck = make_bald_ict(model, rng, variety, expression)
    if rng.random() < 0.5:
        bald, neck = mirror(bald), neck._replace(x=-neck.x)
    return complete_head(bald, neck, rng, variety)


def complete_head(
    bald: LabelledMesh, neck: Neck, rng: np.random.Generator, variety: Variety = "mild"
) -> LabelledMesh:
    """Put hair and shoulders on a bald head, and glasses on one in seven.

    Args:
        bald: Skin, eyes and mouth.
        neck: Where its neck ends.
        rng: Random numbers.
        variety: Which kind of faces.

    Returns:
        The whole head.
    """
    if variety == "any":
        return dress_head(bald, neck, rng)
    skin, cut = select(bald, SKIN), sample_haircut(rng)
    parts = [bald, make_bust(neck, rng), make_cap(skin, cut, rng)]
    if cut.length:
        parts.append(make_long_hair(skin, cut, rng))
    if rng.random() < 0.15:
        parts.append(make_glasses(skin, find_eyes(select(bald, EYE)), rng))
    return join(parts)
