"""Shape and appearance in one model."""

from pathlib import Path

import numpy as np
import pytest
import torch

from skinnet.appearance.joint import JointModel
from skinnet.errors import InputError

DEVIATIONS = np.array([30.0, 10.0, 3.0])


def people(count: int = 8) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    betas = rng.standard_normal((count, 4)) * [50, 20, 10, 5]
    alphas = rng.standard_normal((count, 3)) * DEVIATIONS
    alphas[:, 0] += betas[:, 0]
    return alphas, betas


def test_all_components_reproduce_who_was_learnt() -> None:
    alphas, betas = people()
    model = JointModel.fit(alphas, betas, DEVIATIONS)
    assert len(model.statistics.variances) == 7 and model.explained.sum() == pytest.approx(1)
    for alpha, beta in zip(alphas, betas, strict=True):
        found = model.reconstruct(model.project(alpha, beta))
        assert np.allclose(found[0], alpha, atol=1e-3) and np.allclose(found[1], beta, atol=1e-3)


def test_by_default_both_halves_weigh_the_same() -> None:
    alphas, betas = people()
    model = JointModel.fit(alphas, betas, DEVIATIONS)
    shape = (model.weight * alphas / DEVIATIONS).var(0).sum()
    assert shape == pytest.approx(betas.var(0).sum())
    heavy = JointModel.fit(alphas, betas, DEVIATIONS, weight=1e4, components=1)
    assert heavy.weight == 1e4
    alpha, _ = heavy.reconstruct(heavy.project(alphas[0], betas[0]))
    light, _ = JointModel.fit(alphas, betas, DEVIATIONS, 1e-4, 1).reconstruct(np.ones(1))
    assert np.abs(alpha - alphas.mean(0)).max() > 1 and np.isfinite(light).all()


def test_what_goes_together_takes_one_component() -> None:
    _, betas = people()
    alphas = betas[:, :3] * [1, 2, 3]
    model = JointModel.fit(alphas, betas[:, :3], np.ones(3))
    assert len(model.statistics.variances) == 3


def test_it_is_a_module_with_gradients() -> None:
    model = JointModel.fit(*people(), DEVIATIONS).double()
    gamma = torch.from_numpy(model.sample(3, seed=0)).requires_grad_()
    alpha, beta = model(gamma)
    assert alpha.shape == (3, 3) and beta.shape == (3, 4)
    assert np.allclose(model.reconstruct(gamma[1].detach().numpy())[0], alpha[1].detach())
    assert torch.autograd.gradcheck(model, (gamma,))


def test_samples_have_the_variances_of_the_components() -> None:
    model = JointModel.fit(*people(), DEVIATIONS)
    sampled = model.sample(20000, seed=0)
    assert np.allclose(sampled.var(0) / model.statistics.variances, 1, atol=0.05)


def test_files_hold_the_model_exactly(tmp_path: Path) -> None:
    model, path = JointModel.fit(*people(), DEVIATIONS, components=3), tmp_path / "joint.npz"
    model.save(path)
    found = JointModel.load(path)
    gamma = model.sample(1, seed=0)[0]
    for before, after in zip(model.reconstruct(gamma), found.reconstruct(gamma), strict=True):
        assert np.array_equal(before, after)
    assert found.weight == model.weight and np.array_equal(found.explained, model.explained)
    for deviations in (np.ones(9), np.ones((1, 3)), np.array(["a"])):
        with np.load(path) as file:
            arrays = dict(file) | {"deviations": deviations}
        np.savez(tmp_path / "spoilt.npz", **arrays)
        with pytest.raises(InputError, match="is not a complete file"):
            JointModel.load(tmp_path / "spoilt.npz")


def test_people_that_do_not_match_are_refused() -> None:
    alphas, betas = people()
    with pytest.raises(InputError, match="There are 7 shapes and 8 appearances"):
        JointModel.fit(alphas[:-1], betas, DEVIATIONS)
    with pytest.raises(InputError, match="alpha has 3 coefficients and needs as many positive"):
        JointModel.fit(alphas, betas, DEVIATIONS[:2])
    with pytest.raises(InputError, match="got 3, the least 0"):
        JointModel.fit(alphas, betas, DEVIATIONS * [1, 0, 1])
    with pytest.raises(InputError, match="The weight of shape is inf"):
        JointModel.fit(np.zeros_like(alphas), betas, DEVIATIONS)
    with pytest.raises(InputError, match="The weight of shape is -1"):
        JointModel.fit(alphas, betas, DEVIATIONS, weight=-1.0)
    with pytest.raises(InputError, match="9 components were asked for, and 8 subjects span 7"):
        JointModel.fit(alphas, betas, DEVIATIONS, components=9)


@pytest.mark.parametrize(
    ("name", "value"), [("deviations", np.ones(3) * 1j), ("deviations", np.array([1, np.nan, 1]))]
)
def test_a_changed_array_is_refused(tmp_path: Path, name: str, value: np.ndarray) -> None:
    JointModel.fit(*people(), DEVIATIONS).save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        np.savez(tmp_path / "a.npz", **dict(file) | {name: value})
    with pytest.raises(InputError, match="is not a complete file of skinnet's"):
        JointModel.load(tmp_path / "a.npz")
