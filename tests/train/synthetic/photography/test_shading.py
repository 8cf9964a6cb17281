"""Light of lamps and shadows."""

import torch

from train.synthetic.photography.shading import shade
from train.synthetic.scene import SceneParameters


def test_what_no_lamp_reaches_is_darker(scene: SceneParameters) -> None:
    normal = torch.tensor([0.0, 0, 1])[None, :, None, None].expand(6, -1, 4, 4)
    whole = torch.ones(6, 1, 4, 4)
    mask = torch.full((6, 4, 4), -1)
    specular = scene.face.skin.specular
    bright, dark = (
        shade(scene.light, specular, normal, whole, bits, whole) for bits in (mask, mask * 0)
    )
    assert (dark.diffuse < bright.diffuse).all() and (dark.specular < bright.specular).all()
    assert (dark.diffuse > 0).all()
