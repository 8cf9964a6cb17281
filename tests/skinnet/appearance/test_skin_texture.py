"""Textures give their albedo; those that are not skin are refused."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from benchmarks.appearance import make_person
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError


def test_albedo_is_skin_and_offset(stack: SubjectStack, colour: SkinColour) -> None:
    face = stack.texture(0)
    f_mel, f_blood = (torch.from_numpy(m.ravel()) for m in (face.f_mel, face.f_blood))
    skin = colour.skin(f_mel, f_blood).numpy().T.reshape(*face.mask.shape, 3)
    albedo = face.albedo(colour)
    assert np.allclose(albedo[face.mask], (skin + face.offset)[face.mask])
    assert (albedo[~face.mask] == 0).all()


@pytest.mark.parametrize(("name", "value", "sentence"), [
    ("f_mel", 12.3, "person 0: f_mel is a volume fraction .* got 12.3. Was it given in percent"),
    ("f_blood", -0.1, "person 0: f_blood is a volume fraction .* got -0.1"),
    ("f_blood", np.nan, "person 0: f_blood has a known texel that is not finite"),
    ("offset", np.inf, "person 0: offset has a known texel that is not finite"),
])  # fmt: skip
def test_textures_that_are_not_skin_are_refused(name: str, value: float, sentence: str) -> None:
    face = make_person(20, 0)
    spoilt = getattr(face, name).copy()
    spoilt[10, 10] = value
    with pytest.raises(InputError, match=sentence):
        replace(face, **{name: spoilt})
