"""Synthetic faces as training data."""

from pathlib import Path

import numpy as np
import pytest
import torch
from torch.utils.data import DataLoader

from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.sampling.face_sampling import MELANIN_RANGE, RANDOMISED_MELANIN_RANGE
from train.synthetic.scene import SceneParameters, map_tensors


def list_tensors(scene: SceneParameters) -> list[torch.Tensor]:
    """All tensors of a scene, in order."""
    tensors: list[torch.Tensor] = []

    def keep(value: torch.Tensor) -> torch.Tensor:
        tensors.append(value)
        return value

    map_tensors(keep, scene)
    return tensors


def test_the_same_index_is_the_same_scene_in_its_split_alone(data: SyntheticFaces) -> None:
    heads = data.buffers["train"]
    first, again = (SyntheticScenes(heads, "train", 4, seed=0)[2] for _ in range(2))
    other = SyntheticScenes(heads, "val", 4, seed=0)[2]
    pairs = zip(list_tensors(first), list_tensors(again), strict=True)
    assert all(torch.equal(a, b) for a, b in pairs)
    assert first.face.skin.melanin.fraction != other.face.skin.melanin.fraction


def test_scenes_are_float32_but_for_their_heads(data: SyntheticFaces) -> None:
    for randomised in (False, True):
        scenes = SyntheticScenes(
            data.buffers["train"], "train", 1, seed=0, domain_randomised=randomised
        )
        tensors = list_tensors(scenes[0])
        assert {one.dtype for one in tensors[5:]} == {torch.float32}


def test_worker_processes_hand_over_the_same_scenes(data: SyntheticFaces) -> None:
    scenes = SyntheticScenes(data.buffers["train"], "train", 2, seed=0)
    (here,), (there,) = (list(DataLoader(scenes, 2, num_workers=count)) for count in (0, 1))
    assert isinstance(there, SceneParameters)
    pairs = zip(list_tensors(here), list_tensors(there), strict=True)
    assert all(torch.equal(a, b) for a, b in pairs)


@pytest.mark.slow
def test_training_alone_sees_the_darkest_and_shiniest_skin(casts: Path) -> None:
    data = SyntheticFaces(64, 4, heads=4, val_heads=4, val_samples=80, geometry=str(casts))
    data.setup("fit")
    training, fixed = data.stream(20, None).dataset, data.val_dataloader().dataset
    trained, kept = ([some[index].face.skin for index in range(80)] for some in (training, fixed))
    melanin = np.array([skin.melanin.fraction for skin in trained])
    assert melanin.min() < 0.02
    assert MELANIN_RANGE[1] < melanin.max() <= RANDOMISED_MELANIN_RANGE[1]
    assert max(skin.melanin.fraction for skin in kept) <= MELANIN_RANGE[1]
    oily, usual = (np.mean([skin.specular.oil for skin in some]) for some in (trained, kept))
    assert oily > 1.2 * usual


def test_splits_have_heads_of_their_own(data: SyntheticFaces) -> None:
    heads = [data.buffers[split].normal[0] for split in ("train", "val", "test")]
    assert not any(torch.equal(heads[k], heads[k - 1]) for k in range(3))
