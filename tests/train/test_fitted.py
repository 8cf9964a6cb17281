"""Fitted scans as training data."""

from pathlib import Path

import numpy as np
import pytest
import torch
from pipeline_scans import SIZE
from torch.utils.data import default_collate

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.maps_file import load_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError
from skinnet.physics import to_display
from train.batch import Batch
from train.fitted import FittedFaces, FittedScenes
from train.fitted_scenes import average_texels


@pytest.fixture(scope="module")
def data(faces: Path) -> FittedFaces:
    made = FittedFaces(str(faces), size=48, texels=24, shots=3, batch_size=4)
    made.setup("fit")
    return made


def batch(data: FittedFaces, split: str = "train") -> Batch:
    scenes = FittedScenes(data, split, 4)
    return data.on_after_batch_transfer(default_collate([scenes[i] for i in range(4)]), 0)


def test_the_truth_explains_the_picture(data: FittedFaces) -> None:
    made = batch(data)
    linear = data.decoder.compose(*made.truth[:5], made.capture)
    skin = (made.mask > 0.5)[:, None].expand_as(linear)
    assert 0.1 < (made.mask > 0.5).float().mean() < 0.9
    error = (to_display(linear) - made.photograph)[skin].abs()
    assert error.median() < 0.03  # blur and grain


def test_the_pigments_are_the_faces_own(data: FittedFaces, faces: Path) -> None:
    texture, _ = load_maps(faces / "a_maps.npz")
    made = batch(data)
    skin = made.mask > 0.5
    mean = made.truth.melanin[skin].mean().item()
    assert mean == pytest.approx(texture.f_mel.mean(), rel=0.2)


def test_pictures_are_the_same_twice_and_differ_between_splits(data: FittedFaces) -> None:
    first, again = (batch(data).photograph for _ in range(2))
    assert torch.equal(first, again)
    assert not torch.equal(first, batch(data, "val").photograph)


def test_the_texture_lies_the_right_way_up(data: FittedFaces) -> None:
    # The face looks ahead in the first view: its left, u > 1/2, is on the picture's right.
    first = data.views[0]
    u, v = np.moveaxis(first.uv.numpy(), -1, 0)
    hit = first.hit.numpy() > 0
    columns, rows = np.meshgrid(np.arange(48), np.arange(48))
    assert np.corrcoef(columns[hit], u[hit])[0, 1] > 0.9
    assert np.corrcoef(rows[hit], v[hit])[0, 1] > 0.9
    assert first.normal.numpy()[hit][:, 2].mean() > 0.6


def test_averaging_keeps_the_mean_of_what_is_known() -> None:
    rng = np.random.default_rng(0)
    maps = [rng.random((16, 16), np.float32) for _ in range(2)]
    mask = rng.random((16, 16)) < 0.5
    whole = SkinTexture(*maps, np.zeros((16, 16, 3), np.float32), mask)
    values, share = average_texels(whole, 8)
    blocks = mask.reshape(8, 2, 8, 2).sum((1, 3))
    np.testing.assert_allclose(share, blocks / 4, rtol=1e-6)
    summed = np.where(mask, maps[1], 0).reshape(8, 2, 8, 2).sum((1, 3))
    np.testing.assert_allclose(values[0][blocks > 0], (summed / np.maximum(blocks, 1))[blocks > 0],
                               rtol=1e-5)  # fmt: skip


def test_half_of_the_faces_have_a_sampled_skin(faces: Path, tmp_path: Path) -> None:
    texture, colour = load_maps(faces / "a_maps.npz")
    zero = np.zeros((SIZE, SIZE, 3), np.float32)
    people = {
        str(k): lambda k=k: SkinTexture(texture.f_mel * k, texture.f_blood, zero, texture.mask)
        for k in (1, 2, 4)
    }
    stack = write_stack(tmp_path / "stack", people, colour, "test")
    HybridModel.fit(stack).save(tmp_path / "hybrid.npz")
    data = FittedFaces(str(faces), str(tmp_path / "hybrid.npz"), size=16, texels=8, shots=1)
    data.setup("fit")
    scenes = FittedScenes(data, "train", 40)
    own = data.textures[0][0]
    sampled = [not np.array_equal(scenes[i].texture, own) for i in range(40)]
    assert 8 < sum(sampled) < 32


def test_a_folder_without_faces_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no NAME_maps.npz with NAME_face.obj"):
        FittedFaces(str(tmp_path)).setup("fit")
