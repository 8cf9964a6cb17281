"""The hybrid model gives maps back, follows gradients and stays on the skin manifold."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import torch

from benchmarks.appearance import make_person
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack


def test_maps_of_the_hybrid_come_back(stack: SubjectStack) -> None:
    model, face = HybridModel.fit(stack), stack.texture(2)
    found = model.texture(model.project(face), "again")
    assert found.name == "again" and np.array_equal(found.mask, face.mask)
    for name in ("f_mel", "f_blood", "offset"):
        assert np.allclose(getattr(found, name), getattr(face, name), atol=1e-5)
    assert np.allclose(
        found.albedo(model.colour), model.reconstruct(model.project(face)), atol=1e-6
    )


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
