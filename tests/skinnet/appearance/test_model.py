"""The hybrid and the linear model: exact on what they learnt, differentiable, kept in files."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks.appearance import make_person
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError
from skinnet.physics import SkinLookup

KINDS: list[type[AppearanceModel]] = [HybridModel, LinearModel]


@pytest.fixture(params=KINDS)
def model(request: pytest.FixtureRequest, stack: SubjectStack) -> AppearanceModel:
    kind: type[AppearanceModel] = request.param
    return kind.fit(stack)


def test_all_components_reproduce_who_was_learnt(
    model: AppearanceModel, stack: SubjectStack
) -> None:
    assert len(model.statistics.variances) == 6 and model.explained.sum() == pytest.approx(1)
    betas = model.coefficients(stack)
    for index in range(len(stack.names)):
        face = stack.texture(index)
        beta = model.project(face)
        assert np.allclose(beta, betas[index], atol=1e-4)
        assert np.allclose(model.reconstruct(beta), face.albedo(stack.colour), atol=2e-5)
    assert np.allclose(betas.mean(0), 0, atol=1e-4)
    assert np.allclose(betas.var(0, ddof=1), model.statistics.variances, rtol=1e-4)


def test_fewer_components_are_the_first_ones(model: AppearanceModel, stack: SubjectStack) -> None:
    fewer = type(model).fit(stack, components=2)
    assert np.allclose(fewer.statistics.basis, model.statistics.basis[:2], atol=1e-6)
    assert np.allclose(fewer.explained, model.explained[:2])


def test_the_module_is_what_reconstructs(model: AppearanceModel) -> None:
    betas = model.sample(4, seed=0)
    pictures = model(torch.from_numpy(betas).float().reshape(2, 2, -1))
    assert pictures.shape == (2, 2, 3, 20, 20)
    for beta, picture in zip(betas, pictures.flatten(0, 1), strict=True):
        assert np.allclose(model.reconstruct(beta), picture.movedim(0, -1).numpy(), atol=1e-6)
    assert (pictures[..., torch.from_numpy(~model.mask)] == 0).all()


def test_gradients_are_right(stack: SubjectStack, monkeypatch: pytest.MonkeyPatch) -> None:
    small = np.zeros((20, 20), bool)
    small[9:11, 9:11] = True
    for kind in KINDS:
        model = kind.fit(stack, components=2, mask=small).double()
        beta = torch.tensor([[0.3, -0.2], [1.0, 0.1]], dtype=torch.float64)
        ours = torch.autograd.functional.jacobian(model, beta)
        with monkeypatch.context() as patch:
            patch.setattr(SkinLookup, "sample", _make_exact(stack.colour))
            exact = torch.autograd.functional.jacobian(model, beta)
            assert torch.autograd.gradcheck(model, (beta.requires_grad_(),))
        assert (ours - exact).abs().max() < 0.01 * exact.abs().max()


def _make_exact(colour: SkinColour) -> Callable[..., torch.Tensor]:
    """The closed form in the place of a table, whose gradients are within one percent."""
    matrix = torch.from_numpy(colour.matrix @ colour.calibration.T)

    def sample(
        lookup: SkinLookup, _: torch.Tensor, f_mel: torch.Tensor, f_blood: torch.Tensor
    ) -> torch.Tensor:
        return (lookup.reflectance.bands(f_mel, f_blood) @ matrix).movedim(-1, 1)

    return sample


@pytest.mark.parametrize("scales", [np.ones(4), np.array([1, 1, 1, 1, 0.0]), np.full(5, np.nan)])
def test_scales_are_positive_and_as_many_as_channels(
    stack: SubjectStack, scales: np.ndarray
) -> None:
    with pytest.raises(InputError, match="scales are 5 positive numbers, one a channel"):
        HybridModel.fit(stack, scales=scales)


def test_more_components_than_subjects_are_refused(stack: SubjectStack) -> None:
    for kind in KINDS:
        with pytest.raises(InputError, match="7 components were asked for, and 7 subjects span 6"):
            kind.fit(stack, components=7)


def test_a_face_of_another_size_is_refused(model: AppearanceModel) -> None:
    with pytest.raises(InputError, match="person 1 has 32 texels a side and the model 20"):
        model.project(make_person(32, 1))


def test_a_face_with_holes_is_projected_by_what_it_has(
    model: AppearanceModel, stack: SubjectStack
) -> None:
    face = stack.texture(1)
    mask = face.mask & (np.arange(20) % 4 > 0)
    holes = replace(face, mask=mask, f_mel=np.where(mask, face.f_mel, np.float32(np.nan)))
    assert np.allclose(model.project(holes), model.project(face), rtol=1e-2, atol=2e-2)
    with pytest.raises(InputError, match="too few for its 6 components"):
        model.project(replace(face, mask=np.zeros_like(mask)))


def test_files_hold_the_model_exactly(model: AppearanceModel, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    model.save(path)
    found = type(model).load(path)
    assert [file.name for file in tmp_path.iterdir()] == ["model.npz"]
    for name in ("mean", "basis", "variances", "scales", "total", "subjects"):
        assert np.array_equal(getattr(found.statistics, name), getattr(model.statistics, name))
    assert np.array_equal(found.mask, model.mask)
    assert found.colour.to_record() == model.colour.to_record()
    beta = model.sample(1, seed=0)[0]
    assert np.array_equal(found.reconstruct(beta), model.reconstruct(beta))
    assert found.statistics.basis.dtype == np.float32


def test_what_is_missing_in_some_is_filled(tmp_path: Path, colour: SkinColour) -> None:
    def holed(seed: int) -> SkinTexture:
        face = make_person(20, seed)
        face.mask[10] &= seed != 0
        return face

    stack = write_stack(tmp_path, {str(s): partial(holed, s) for s in range(4)}, colour, "holed")
    mask = stack.cover(share=0.75).mask
    for kind in KINDS:
        model = kind.fit(stack, mask=mask)
        assert np.isfinite(model.statistics.basis).all() and model.mask[10].any()
        assert not kind.fit(stack).mask[10].any()
