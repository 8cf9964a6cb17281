"""Faces of the preset `measured` have the blood and nuisance of measured skins."""

import numpy as np
import pytest
import torch
from torch.utils.data import default_collate

from skinnet.physics import SkinDecoder, SkinPrior, luminance
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.photography.renderer import render
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.sampling.measured_skins import MeasuredSkins


@pytest.fixture(scope="module")
def skins() -> MeasuredSkins:
    return MeasuredSkins()


def test_blood_and_nuisance_have_the_prior_of_their_melanin(skins: MeasuredSkins) -> None:
    rng = np.random.default_rng(0)
    face = sample_face(rng)
    f_mel = torch.tensor(0.12, dtype=torch.float64)
    pigment = face.skin.melanin._replace(fraction=f_mel)
    face = face._replace(skin=face.skin._replace(melanin=pigment))
    sampled = [skins.apply(face, rng).skin for _ in range(2000)]
    blood = torch.stack([skin.hemoglobin.fraction for skin in sampled]).log()
    axis = torch.linspace(-7, -1.9, 400, dtype=torch.float64)
    weight = SkinPrior().log_density(f_mel, axis.exp()).exp()
    mean = (weight * axis).sum() / weight.sum()
    deviation = ((weight * (axis - mean) ** 2).sum() / weight.sum()).sqrt()
    assert abs(blood.mean() - mean) < 0.1 * deviation
    assert blood.std() == pytest.approx(float(deviation), rel=0.1)
    thickness = torch.stack([skin.nuisance.thickness for skin in sampled])
    expected, covariance, _ = SkinPrior().condition(f_mel, blood.exp())
    deviation = (thickness - expected.thickness) / covariance[..., 0, 0].sqrt()
    assert deviation.mean().item() == pytest.approx(0, abs=0.1)
    assert deviation.std().item() == pytest.approx(1, rel=0.1)


def test_melanin_and_all_else_are_left(skins: MeasuredSkins) -> None:
    rng = np.random.default_rng(1)
    face = sample_face(rng)
    changed = skins.apply(face, rng)
    assert changed.skin.melanin is face.skin.melanin and changed.marks is face.marks


def test_only_the_preset_measured_has_them() -> None:
    assert SyntheticFaces().measured is not None
    assert SyntheticFaces(optics="calibrated").measured is None


def test_a_thin_dermis_is_darker(data: SyntheticFaces) -> None:
    scenes = SyntheticScenes(data.buffers["test"], "test", 2, seed=0)
    scene = default_collate([scenes[0], scenes[1]])
    skin = scene.face.skin
    thin = skin._replace(nuisance=skin.nuisance._replace(thickness=torch.full((2,), -1.0)))
    scenes_of = (scene, scene._replace(face=scene.face._replace(skin=thin)))
    usual, darker = (render(one, SkinDecoder(), "test").albedo for one in scenes_of)
    assert usual is not None and darker is not None
    assert (luminance(darker) < luminance(usual)).all()
