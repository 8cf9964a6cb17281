"""Each person of a picture has skin of their own, on the face and on the hands."""

from pathlib import Path

import pytest
import torch
from torch.utils.data import default_collate

from train.batch import Batch
from train.synthetic.casts.head_cast import make_blank_cast
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.labels import BODY, CLOTH, EYE, MATERIALS, SKIN
from train.synthetic.painting.paintings import collate_scenes, find_paintings, merge_paintings
from train.synthetic.scene import HeadBuffers, SceneParameters, map_tensors

SIZE = 32
CODES = (0, 1, BODY, BODY + 1)


@pytest.fixture(scope="module")
def heads() -> HeadBuffers:
    """Two pictures: one with two people and their hands in strips, one with a bare arm alone."""
    cast = make_blank_cast(SIZE)
    cast.normal[..., 2] = 127
    cast.sky_visibility[:] = 255
    cast.label[:] = [[SKIN + MATERIALS * CODES[column // 8] for column in range(SIZE)]]
    cast.label[:4], cast.label[4:6, :8] = 0, EYE
    cast.label[28:] = CLOTH
    several = cast.to_buffers()
    alone = map_tensors(torch.Tensor.clone, several)
    alone.label[:] = SKIN + MATERIALS * BODY
    return HeadBuffers(*(torch.stack(pair) for pair in zip(several, alone, strict=True)))


@pytest.fixture(scope="module")
def scenes(heads: HeadBuffers) -> SyntheticScenes:
    return SyntheticScenes(heads, "train", 8, seed=2, variety="any")


@pytest.fixture(scope="module")
def batch(scenes: SyntheticScenes) -> SceneParameters:
    plain = collate_scenes([scenes[index] for index in range(4)])
    return plain._replace(camera=plain.camera._replace(mirror=torch.zeros(4)))


@pytest.fixture(scope="module")
def rendered(batch: SceneParameters) -> Batch:
    return SyntheticFaces(size=SIZE, optics="calibrated").render(batch, "train")


def test_paintings_are_those_that_are_seen(batch: SceneParameters) -> None:
    paintings = find_paintings(batch.head.label)
    assert paintings.picture.tolist() == [0, 0, 0, 0, 1, 2, 2, 2, 2, 3]
    assert paintings.number.tolist() == [*CODES, BODY, *CODES, BODY]
    assert paintings.first.tolist() == [0, 4, 5, 9]
    assert len(batch.face.skin.melanin.fraction) == 10
    values = torch.arange(10.0).reshape(-1, 1, 1, 1).expand(-1, 1, SIZE, SIZE)
    merged = merge_paintings(paintings, values)[:, 0]
    assert torch.equal(merged, paintings.owner.float())


def test_hands_have_the_pigments_of_their_person_and_people_differ(batch: SceneParameters) -> None:
    for pigment in (batch.face.skin.melanin, batch.face.skin.hemoglobin):
        first, second, own, other = pigment.fraction[:4].tolist()
        assert (first, second) == (own, other) and first != second


def test_each_pixel_has_the_base_pigment_of_its_person(
    batch: SceneParameters, rendered: Batch
) -> None:
    assert rendered.truth is not None
    paintings, skin = find_paintings(batch.head.label), batch.face.skin
    for true, pigment in zip(rendered.truth[:2], (skin.melanin, skin.hemoglobin), strict=True):
        for row, picture in enumerate(paintings.picture.tolist()):
            own = (paintings.owner == row) & (batch.head.label % MATERIALS == SKIN)
            ratio = true[picture][own[picture]] / pigment.fraction[row]
            assert 0.6 < ratio.median() < 1.6


def test_a_face_for_each_painting_is_asked_for(heads: HeadBuffers) -> None:
    scenes = SyntheticScenes(heads, "train", 2, seed=2, variety="mild")
    batch = default_collate([scenes[0], scenes[1]])
    with pytest.raises(ValueError, match="5 paintings and the scene has 2 faces"):
        SyntheticFaces(size=SIZE, optics="calibrated").render(batch, "train")


def test_truth_is_finite_and_skin_is_where_its_label_is(
    batch: SceneParameters, rendered: Batch
) -> None:
    assert rendered.truth is not None and rendered.albedo is not None
    assert all(bool(one.isfinite().all()) for one in (*rendered.truth, rendered.albedo))
    skin = batch.head.label % MATERIALS == SKIN
    assert (rendered.mask[~skin] == 0).all() and rendered.mask[skin].mean() > 0.6


def test_the_same_index_is_the_same_scene_in_any_batch(scenes: SyntheticScenes) -> None:
    data = SyntheticFaces(size=SIZE, optics="calibrated")
    together = data.render(collate_scenes([scenes[0], scenes[1]]), "train").photograph
    alone = data.render(collate_scenes([scenes[1]]), "train").photograph
    # A JPEG of one picture alone may round otherwise.
    assert (together[1] - alone[0]).abs().max() < 0.02


@pytest.mark.slow
def test_pictures_of_any_are_rendered(tmp_path: Path) -> None:
    data = SyntheticFaces(
        SIZE, 6, val_heads=12, val_samples=12, geometry=str(tmp_path), variety="any"
    )
    data.setup("validate")
    for scene in data.val_dataloader():
        batch = data.render(scene, "val")
        assert batch.truth is not None
        assert all(bool(value.isfinite().all()) for value in batch.truth)
        assert (batch.mask.amax((1, 2)) > 0.5).all()
