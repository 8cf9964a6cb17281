"""Whole synthetic heads: bald ones with hair, glasses and shoulders put on."""

import numpy as np
from jaxtyping import Float

from train.synthetic.bald_procedural import bare_procedural
from train.synthetic.body import Neck, bust
from train.synthetic.glasses import glasses
from train.synthetic.hair import cap, curtain, draw_cut
from train.synthetic.ict_model import IctHead, bare_ict
from train.synthetic.labelled_mesh import Part, joined, mirrored, only
from train.synthetic.labels import EYE, SKIN

Head = Part


def procedural_head(draw: np.random.Generator) -> Head:
    """A head of `skinnet.shape.procedural_head`, dressed."""
    return dressed(*bare_procedural(draw), draw)


def ict_head(model: IctHead, draw: np.random.Generator) -> Head:
    """A head of ICT-FaceKit with an expression and a gaze, dressed; half are mirrored."""
    bare, neck = bare_ict(model, draw)
    if draw.random() < 0.5:
        bare, neck = mirrored(bare), neck._replace(x=-neck.x)
    return dressed(bare, neck, draw)


def dressed(bare: Part, neck: Neck, draw: np.random.Generator) -> Head:
    skin, cut = only(bare, SKIN), draw_cut(draw)
    parts = [bare, bust(neck, draw), cap(skin, cut, draw)]
    if cut.length:
        parts.append(curtain(skin, cut, draw))
    if draw.random() < 0.15:
        parts.append(glasses(skin, _eyes(only(bare, EYE)), draw))
    return joined(parts)


def _eyes(eyes: Part) -> Float[np.ndarray, "2 3"]:
    """The foremost points of both eyes."""
    sides = [eyes.vertices[sign * eyes.vertices[:, 0] > 0] for sign in (1, -1)]
    return np.stack([(one.min(0) + one.max(0)) / 2 * [1, 1, 0] + [0, 0, one[:, 2].max()]
                     for one in sides])  # fmt: skip
