"""Synthetic portraits are what the physics makes of their truth."""

import numpy as np
import pytest
import torch
from kornia.color import rgb_to_linear_rgb

from skinnet.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.decoder import SkinDecoder, srgb
from train.batch import Batch
from train.render import render
from train.scene import draw_scene
from train.synthetic import Scenes

SIZE = 48


def scenes(count: int, **changes: float) -> dict[str, torch.Tensor]:
    drawn = [Scenes("train", count, SIZE, seed=3)[index] for index in range(count)]
    stacked = {name: torch.from_numpy(np.stack([d[name] for d in drawn])) for name in drawn[0]}
    return {
        name: torch.full_like(value, changes[name]) if name in changes else value
        for name, value in stacked.items()
    }


@pytest.fixture(scope="module")
def clean() -> Batch:
    return render(scenes(8, grain=0.0, blur=0.0), SkinDecoder())


def test_a_photograph_is_what_the_decoder_makes_of_its_truth(clean: Batch) -> None:
    assert clean.truth is not None and clean.capture is not None
    decoder = SkinDecoder(fast=False)
    again = srgb(decoder.compose(*clean.truth[:5], clean.capture))
    assert (again - clean.photograph).abs().max() < 0.01


def test_truth_is_finite_and_in_range(clean: Batch) -> None:
    truth = clean.truth
    assert truth is not None
    assert all(bool(value.isfinite().all()) for value in truth)
    assert 0 < truth.melanin.min() and truth.melanin.max() <= F_MEL_MAX * 1.001
    assert 0 < truth.hemoglobin.min() and truth.hemoglobin.max() <= F_BLOOD_MAX * 1.001
    assert truth.mask.min() >= 0 and truth.mask.max() <= 1
    assert clean.photograph.min() >= 0 and clean.photograph.max() <= 1


def test_every_portrait_shows_skin_and_something_else(clean: Batch) -> None:
    share = clean.mask.mean((1, 2))
    assert share.min() > 0.05 and share.max() < 0.8


def test_what_is_not_skin_has_no_shading_and_is_its_own_offset(clean: Batch) -> None:
    assert clean.truth is not None
    elsewhere = clean.mask == 0
    assert clean.truth.shading[elsewhere].abs().max() == 0
    linear = rgb_to_linear_rgb(clean.photograph).movedim(1, -1)
    offset = clean.truth.offset.movedim(1, -1)
    assert (offset[elsewhere] - linear[elsewhere]).abs().max() < 0.02


def test_more_melanin_makes_a_darker_face() -> None:
    pale, dark = (
        render(scenes(4, f_mel=f_mel, grain=0.0), SkinDecoder()).photograph for f_mel in (0.02, 0.2)
    )
    assert (pale.mean((1, 2, 3)) > dark.mean((1, 2, 3))).all()


def test_the_same_seed_draws_the_same_scene_and_another_split_another() -> None:
    first, again, other = (Scenes(split, 4, SIZE, seed=0)[2] for split in ("train", "train", "val"))
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert first["f_mel"] != other["f_mel"]


def test_scenes_cover_pale_and_dark_skin_evenly() -> None:
    drawn = [draw_scene(np.random.default_rng(index), 8)["f_mel"] for index in range(400)]
    below = np.mean(np.array(drawn) < 0.049)
    assert 0.42 < below < 0.58
