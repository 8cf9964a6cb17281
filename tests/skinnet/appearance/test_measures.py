"""Measures without refitting are those of models that are fitted again."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance import _feature_blocks
from skinnet.appearance._model import AppearanceModel
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import measure
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError

Without = Callable[[int], SubjectStack]
KINDS: list[type[AppearanceModel]] = [HybridModel, LinearModel]


def rms(albedo: np.ndarray, other: np.ndarray, mask: np.ndarray) -> float:
    return float(np.sqrt(((albedo - other)[mask] ** 2).mean()))


def albedos(stack: SubjectStack) -> list[np.ndarray]:
    return [stack.texture(i).albedo(stack.colour) for i in range(len(stack.names))]


@pytest.mark.parametrize("kind", KINDS)
def test_leaving_one_out_is_an_honest_refit(
    kind: type[AppearanceModel], stack: SubjectStack, without: Without
) -> None:
    model = kind.fit(stack)
    found = measure(model, stack, texels=None).generalisation
    assert found.counts.tolist() == [1, 2, 3, 4, 5] and found.values.shape == (5, 7)
    for index in (0, 4):
        others, face = without(index), stack.texture(index)
        for count, error in zip(found.counts, found.values[:, index], strict=True):
            refit = kind.fit(others, int(count), model.mask, model.statistics.scales)
            again = refit.reconstruct(refit.project(face))
            assert error == pytest.approx(
                rms(again, face.albedo(stack.colour), model.mask), rel=1e-3
            )


@pytest.mark.parametrize("kind", KINDS)
def test_specificity_is_that_of_decoded_samples(
    kind: type[AppearanceModel], stack: SubjectStack
) -> None:
    model = kind.fit(stack)
    found = measure(model, stack, samples=5, seed=3, texels=None).specificity
    subjects = albedos(stack)
    for row, beta in enumerate(model.sample(5, seed=3)):
        for count, distance in zip(found.counts, found.values[:, row], strict=True):
            face = model.reconstruct(np.where(np.arange(6) < count, beta, 0))
            nearest = min(rms(face, other, model.mask) for other in subjects)
            assert distance == pytest.approx(nearest, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_compactness_is_the_share_of_the_variance(
    kind: type[AppearanceModel], stack: SubjectStack
) -> None:
    model = kind.fit(stack, components=5)
    found = measure(model, stack, texels=None)
    assert np.allclose(found.compactness, np.cumsum(kind.fit(stack).explained)[:5])
    subjects, mean = albedos(stack), model.reconstruct(np.zeros(5))
    betas = model.coefficients(stack)
    variance = sum(rms(mean, face, model.mask) ** 2 for face in subjects)
    for count, share in zip(
        found.colour_compactness.counts, found.colour_compactness.mean, strict=True
    ):
        cut = np.where(np.arange(5) < count, betas, 0)
        left = sum(
            rms(model.reconstruct(beta), face, model.mask) ** 2
            for beta, face in zip(cut, subjects, strict=True)
        )
        assert share == pytest.approx(1 - left / variance, abs=1e-4)


def test_for_the_linear_model_both_compactnesses_are_one(stack: SubjectStack) -> None:
    found = measure(LinearModel.fit(stack), stack)
    assert np.allclose(found.colour_compactness.mean, found.compactness[:5], atol=1e-6)


def test_scaled_channels_and_subsets_of_texels(stack: SubjectStack, without: Without) -> None:
    model = LinearModel.fit(stack, scales=np.array([1.0, 0.3, 0.2]))
    error = measure(model, stack).generalisation.values[2, 1]
    refit = LinearModel.fit(without(1), 3, model.mask, model.statistics.scales)
    face = stack.texture(1)
    again = refit.reconstruct(refit.project(face))
    assert error == pytest.approx(rms(again, face.albedo(stack.colour), model.mask), rel=1e-3)
    hybrid = HybridModel.fit(stack)
    whole, part = (measure(hybrid, stack, texels=n).generalisation.mean for n in (None, 120))
    assert np.allclose(part, whole, rtol=0.2) and not np.array_equal(part, whole)


def test_blocks_of_any_size_give_the_same(
    stack: SubjectStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = HybridModel.fit(stack)
    whole = measure(model, stack, samples=4).summary()
    monkeypatch.setattr(_feature_blocks, "BLOCK_BYTES", 3000)
    assert stack.read_blocks(model.mask).width == 21
    small = measure(HybridModel.fit(stack), stack, samples=4).summary()
    for name in ("compactness", "generalisation", "specificity", "colour_compactness"):
        assert list(small[name].values()) == pytest.approx(list(whole[name].values()), rel=1e-4)


@pytest.mark.parametrize("counts", [[], [0, 1], [6]])
def test_counts_that_a_smaller_set_cannot_have_are_refused(
    stack: SubjectStack, counts: list[int]
) -> None:
    with pytest.raises(InputError, match="Models of 6 of the 7 subjects, with at most 6"):
        measure(LinearModel.fit(stack), stack, np.array(counts, int))


def test_two_subjects_are_too_few(
    tmp_path: Path, persons: dict[str, Callable[[], SkinTexture]], colour: SkinColour
) -> None:
    pair = write_stack(tmp_path, dict(list(persons.items())[:2]), colour, "pair")
    with pytest.raises(InputError, match="needs three or more; the stack has 2"):
        measure(LinearModel.fit(pair), pair)


def test_the_summary_is_json(stack: SubjectStack) -> None:
    found = measure(HybridModel.fit(stack), stack, np.array([2, 4]), samples=3, name="ours")
    summary = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert summary["name"] == "ours" and set(summary["generalisation"]) == {"2", "4"}
    assert set(summary) == {
        "name", "compactness", "colour_compactness", "generalisation", "specificity"
    }  # fmt: skip
