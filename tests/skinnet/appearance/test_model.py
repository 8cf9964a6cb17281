"""The hybrid and the linear model: exact on what they learnt, differentiable, kept in files."""

import json
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from benchmarks.appearance import make_person
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance._scales import compute_equal_effect, compute_equal_variance
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError

KINDS: list[type[AppearanceModel]] = [HybridModel, LinearModel]


@pytest.fixture(params=KINDS)
def model(request: pytest.FixtureRequest, stack: SubjectStack) -> AppearanceModel:
    kind: type[AppearanceModel] = request.param
    return kind.fit(stack)


def rms(difference: np.ndarray) -> float:
    return float(np.sqrt((difference**2).mean()))


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


def test_maps_of_the_hybrid_come_back(stack: SubjectStack) -> None:
    model, face = HybridModel.fit(stack), stack.texture(2)
    found = model.texture(model.project(face), "again")
    assert found.name == "again" and np.array_equal(found.mask, face.mask)
    for name in ("f_mel", "f_blood", "offset"):
        assert np.allclose(getattr(found, name), getattr(face, name), atol=1e-5)
    assert np.allclose(
        found.albedo(model.colour), model.reconstruct(model.project(face)), atol=1e-6
    )


def test_the_module_is_what_reconstructs(model: AppearanceModel) -> None:
    betas = model.sample(4, seed=0)
    pictures = model(torch.from_numpy(betas).float().reshape(2, 2, -1))
    assert pictures.shape == (2, 2, 3, 20, 20)
    for beta, picture in zip(betas, pictures.flatten(0, 1), strict=True):
        assert np.allclose(model.reconstruct(beta), picture.movedim(0, -1).numpy(), atol=1e-6)
    assert (pictures[..., torch.from_numpy(~model.mask)] == 0).all()


def test_gradients_are_right(stack: SubjectStack) -> None:
    small = np.zeros((20, 20), bool)
    small[9:11, 9:11] = True
    for kind in KINDS:
        model = kind.fit(stack, components=2, mask=small).double()
        beta = torch.tensor([[0.3, -0.2], [1.0, 0.1]], dtype=torch.float64, requires_grad=True)
        assert torch.autograd.gradcheck(model, (beta,))


def test_coefficients_are_found_by_descent(stack: SubjectStack) -> None:
    model = HybridModel.fit(stack, components=3)
    target = model(torch.from_numpy(model.sample(1, seed=4)[0]).float())
    scale = torch.from_numpy(np.sqrt(model.statistics.variances)).float()
    z = torch.zeros(3, requires_grad=True)
    descent = torch.optim.LBFGS([z], max_iter=50, line_search_fn="strong_wolfe")

    def loss() -> torch.Tensor:
        descent.zero_grad()
        error = ((model(z * scale) - target) ** 2).sum()
        error.backward()
        return error

    descent.step(loss)
    assert loss() < 1e-6


def test_samples_without_offset_lie_on_the_manifold_of_skin(
    tmp_path: Path, colour: SkinColour
) -> None:
    def bare(seed: int) -> SkinTexture:
        face = make_person(20, seed)
        return replace(face, offset=np.zeros_like(face.offset))

    makers = {str(seed): partial(bare, seed) for seed in range(5)}
    model = HybridModel.fit(write_stack(tmp_path, makers, colour, "bare"))
    for beta in model.sample(5, seed=1):
        face = model.texture(beta)
        assert np.abs(face.offset).max() == 0
        f_mel, f_blood = (torch.from_numpy(m[face.mask]) for m in (face.f_mel, face.f_blood))
        skin = colour.skin(f_mel, f_blood).numpy().T
        assert np.allclose(model.reconstruct(beta)[face.mask], skin, atol=1e-6)


def test_fractions_that_leave_the_unit_interval_are_clamped_and_counted(
    stack: SubjectStack,
) -> None:
    model = HybridModel.fit(stack)
    far = 12 * np.sqrt(model.statistics.variances)[None] * np.eye(6)[:1] * [[-1], [1]]
    assert model.measure_clamping(np.zeros((1, 6))) == 0
    assert 0.2 < model.measure_clamping(far) <= 1
    for beta in far:
        face = model.texture(beta)
        assert face.f_mel.min() >= 0 and face.f_blood.max() <= 1
        assert np.allclose(face.albedo(model.colour), model.reconstruct(beta), atol=1e-6)


def test_blocks_have_equal_variance_by_default(stack: SubjectStack) -> None:
    model = HybridModel.fit(stack)
    (features,) = stack.read_blocks(model.mask)
    blood, mel, *offset = (features / model.statistics.scales[:, None]).var(0, ddof=1).mean(-1)
    assert np.allclose([blood, mel, sum(offset)], 1, rtol=1e-4)
    assert len(set(model.statistics.scales[2:])) == 1
    assert compute_equal_variance(np.zeros((5, 3, 3)), 10).min() > 0


def test_features_can_be_weighed_by_their_effect(stack: SubjectStack) -> None:
    scales = compute_equal_effect(stack)
    assert np.allclose(scales[2:], 1)
    (features,) = stack.read_blocks(stack.cover().mask)
    mean = features.mean((0, 2))
    for channel in range(5):
        steps = mean + np.outer([-0.5, 0.5], np.eye(5)[channel]) * 1e-3 * scales[channel]
        low, high = stack.colour.double().forward(torch.from_numpy(steps.T)).T
        stack.colour.float()
        assert (high - low).norm() == pytest.approx(1e-3, rel=0.05)
    model = HybridModel.fit(stack, scales=scales)
    assert np.array_equal(model.statistics.scales, scales)
    first = HybridModel.fit(stack, components=1, scales=scales)
    equal = HybridModel.fit(stack, components=1)
    errors = [
        rms(m.reconstruct(m.project(stack.texture(i))) - stack.texture(i).albedo(stack.colour))
        for m in (first, equal)
        for i in range(7)
    ]
    assert sum(errors[:7]) < sum(errors[7:])


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


def spoilt(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], None]) -> None:
    with np.load(path) as file:
        arrays: dict[str, Any] = dict(file)
    header = json.loads(str(arrays.pop("header")))
    change(header, arrays)
    np.savez(path, header=np.array(json.dumps(header)), **arrays)


def test_files_of_another_kind_or_format_are_named(stack: SubjectStack, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    LinearModel.fit(stack).save(path)
    with pytest.raises(InputError, match="is a LinearModel, and a HybridModel is wanted"):
        HybridModel.load(path)
    spoilt(path, lambda header, _: header.update(format=2))
    with pytest.raises(InputError, match="has format 2, and this skinnet reads format 1"):
        LinearModel.load(path)
    with pytest.raises(InputError, match="There is no file"):
        LinearModel.load(tmp_path / "none.npz")
    with pytest.raises(InputError, match=r"does not end in \.npz"):
        LinearModel.fit(stack).save(tmp_path / "model.npy")
    with pytest.raises(InputError, match="cannot be written"):
        LinearModel.fit(stack).save(tmp_path / "nowhere" / "model.npz")


CHANGES: list[Callable[[dict[str, Any], dict[str, Any]], object]] = [
    lambda header, _: header.pop("colour"),
    lambda header, _: header.pop("format"),
    lambda header, _: header["colour"].update(optics="none"),
    lambda header, _: header.update(total="much"),
    lambda _, arrays: arrays.pop("basis"),
    lambda _, arrays: arrays.update(basis=arrays["basis"][:, :, 1:]),
    lambda _, arrays: arrays.update(basis=arrays["basis"].astype(np.float64)),
    lambda _, arrays: arrays.update(mean=np.full_like(arrays["mean"], np.nan)),
    lambda _, arrays: arrays.update(mask=~arrays["mask"]),
    lambda _, arrays: arrays.update(mask=arrays["mask"].ravel()),
    lambda _, arrays: arrays.update(variances=np.array(["a"] * 6)),
    lambda _, arrays: arrays.update(scales=np.array([[1.0]])),
]


@pytest.mark.parametrize("change", CHANGES)
def test_damaged_files_are_refused(
    change: Callable[[dict[str, Any], dict[str, Any]], None], stack: SubjectStack, tmp_path: Path
) -> None:
    path = tmp_path / "model.npz"
    HybridModel.fit(stack).save(path)
    spoilt(path, change)
    with pytest.raises(InputError, match="is not a whole model of skinnet's"):
        HybridModel.load(path)


def test_files_cut_short_or_pickled_are_refused(stack: SubjectStack, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    HybridModel.fit(stack).save(path)
    whole = path.read_bytes()
    np.savez(tmp_path / "pickled.npz", header=np.array({"kind": "HybridModel"}, object))
    with zipfile.ZipFile(tmp_path / "empty.npz", "w"):
        pass
    contents = [whole[: len(whole) // 2], whole[:100], b"", b"text", np.zeros(3).tobytes()]
    contents += [(tmp_path / name).read_bytes() for name in ("pickled.npz", "empty.npz")]
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 255
    for content in [*contents, bytes(flipped)]:
        path.write_bytes(content)
        with pytest.raises(InputError, match="is not a whole model of skinnet's"):
            HybridModel.load(path)


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
