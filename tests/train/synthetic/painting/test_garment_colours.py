"""Colours of cloth, the wearer's own skin included, which is never skin in the ground truth."""

import numpy as np
import pytest
import torch
from torch.utils.data import default_collate

from skinnet.mesh import Mesh
from skinnet.physics import SkinDecoder
from skinnet.render import OrthographicView, Scene
from train.synthetic.bodies.bald_procedural import make_bald_procedural
from train.synthetic.bodies.labelled_mesh import join, select
from train.synthetic.bodies.shell import HeadSurface
from train.synthetic.casts.head_cast import cast_view
from train.synthetic.garments.face_masks import make_face_mask
from train.synthetic.labels import FACE_MASK, FILM, SKIN
from train.synthetic.photography.renderer import render
from train.synthetic.sampling.scene_sampling import sample_scene
from train.synthetic.scene import SceneParameters

SIZE = 48
DECODER = SkinDecoder("measured")


@pytest.fixture(scope="module")
def masked() -> SceneParameters:
    """Two bald people in masks of the colour of their skin."""
    bald, _ = make_bald_procedural(np.random.default_rng(2), "any")
    surface = HeadSurface(select(bald, SKIN))
    head = join([bald, make_face_mask(surface, np.random.default_rng(0))])
    view = OrthographicView((SIZE, SIZE), np.array([0.0, 0, 20]), np.eye(3), 0.8 * SIZE / 2)
    cast = cast_view(head, Scene(Mesh(head.vertices, head.triangles)), view)
    scenes = [
        sample_scene(np.random.default_rng(seed), cast.to_buffers(), variety="any")
        for seed in (3, 4)
    ]
    scene: SceneParameters = default_collate(scenes)
    none = torch.zeros(2)
    dim = {"exposure": none + 0.5, "metering": none, "mirror": none, "noise": torch.zeros(2, 2)}
    return wear(scene._replace(camera=scene.camera._replace(**dim)), 1.0)


def wear(scene: SceneParameters, own: float) -> SceneParameters:
    face = scene.face
    green = torch.tensor([0.05, 0.3, 0.1]).expand(2, 3, 2, 3)
    garments = face.garments._replace(own_skin=torch.full((2, 3), own), colours=green)
    style = face.beard_style._replace(beard=torch.zeros(2), stubble=torch.zeros(2))
    cosmetics = face.cosmetics._replace(paint=torch.zeros(2), plaster_opacity=torch.zeros(2))
    face = face._replace(garments=garments, beard_style=style, cosmetics=cosmetics)
    return scene._replace(face=face)


def test_a_mask_of_the_wearers_own_skin_is_not_skin(masked: SceneParameters) -> None:
    batch = render(masked, DECODER, "test")
    assert batch.truth is not None
    mask, cloth = batch.truth.mask, masked.head.label == FACE_MASK
    assert cloth.sum() > 300 and (mask[cloth] == 0).all()
    assert (mask[masked.head.label == SKIN] > 0.5).float().mean() > 0.9
    assert batch.truth.shading[cloth].abs().max() == 0


def test_it_has_the_colour_of_the_skin_and_other_masks_have_not(masked: SceneParameters) -> None:
    own, other = (render(wear(masked, k), DECODER, "test").photograph for k in (1.0, 0.0))
    label = masked.head.label
    for k in (0, 1):
        skin, cloth = ((label[k] == one).nonzero().T for one in (SKIN, FACE_MASK))
        chroma = [
            (value := image[k][:, place[0], place[1]].mean(1)) / value.sum()
            for image, place in ((own, skin), (own, cloth), (other, cloth))
        ]
        assert (chroma[0] - chroma[1]).abs().max() < 0.06
        assert (chroma[1] - chroma[2]).abs().max() > 0.1


def test_a_clear_lens_adds_light_and_leaves_the_mask(masked: SceneParameters) -> None:
    label = masked.head.label.clone()
    rows = slice(SIZE // 4, SIZE // 3)
    skin = label[:, rows] == SKIN
    assert skin.sum() > 50
    label[:, rows][skin] += FILM
    behind = masked._replace(head=masked.head._replace(label=label))
    before, after = (render(one, DECODER, "test").truth for one in (masked, behind))
    assert before is not None and after is not None
    torch.testing.assert_close(before.mask, after.mask)
    offset = (after.offset - before.offset)[:, :, rows]
    assert (offset.mean(1)[skin] > 0).all() and offset.mean(1)[~skin].abs().max() < 1e-6
