"""Components from inner products are those of a direct decomposition, in blocks of any width."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance import _feature_blocks
from skinnet.appearance._feature_blocks import ArrayBlocks
from skinnet.appearance._principal import (
    PrincipalComponents,
    combine_grams,
    compute_components,
    compute_grams,
)
from skinnet.errors import InputError

SCALES = np.array([0.5, 2.0])


def rows(subjects: int = 6, texels: int = 40, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    steps = rng.standard_normal((subjects, 2 * texels)) * np.geomspace(1, 0.1, 2 * texels)
    return (5 + steps).astype(np.float32)


def fit(
    values: np.ndarray, components: int | None = None, width: int | None = None
) -> PrincipalComponents:
    blocks = ArrayBlocks(values, 2, width)
    return compute_components(blocks, compute_grams(blocks), SCALES, components)


def test_they_are_those_of_a_singular_value_decomposition() -> None:
    values, found = rows(), fit(rows())
    scaled = (values.astype(np.float64) - values.mean(0, dtype=np.float64)) / SCALES.repeat(40)
    _, singular, vectors = np.linalg.svd(scaled, full_matrices=False)
    assert np.allclose(found.variances, singular[:5] ** 2 / 5, rtol=1e-5)
    assert found.total == pytest.approx((singular**2).sum() / 5)
    products = found.basis.reshape(5, -1) @ vectors[:5].T
    assert np.allclose(np.abs(products), np.eye(5), atol=1e-5)


@pytest.mark.parametrize("width", [1, 7, 40, 1000])
def test_blocks_of_any_width_give_the_same(width: int) -> None:
    found, whole = fit(rows(), 3, width), fit(rows(), 3)
    assert np.allclose(found.basis, whole.basis, atol=1e-6)
    assert np.allclose(found.mean, whole.mean) and np.allclose(found.variances, whole.variances)


def test_a_memmap_is_read_block_by_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    np.save(tmp_path / "rows.npy", rows())
    mapped = np.load(tmp_path / "rows.npy", mmap_mode="r")
    monkeypatch.setattr(_feature_blocks, "BLOCK_BYTES", 4 * 6 * 2 * 5)
    blocks = ArrayBlocks(mapped, 2)
    assert [block.shape for block in blocks] == [(6, 2, 5)] * 8
    assert np.array_equal(fit(mapped).basis, fit(rows(), width=5).basis)


def test_inner_products_are_summed_over_channels() -> None:
    grams = compute_grams(ArrayBlocks(rows(), 2, 7))
    centred = rows().astype(np.float64) - rows().mean(0, dtype=np.float64)
    halves = np.split(centred, 2, axis=1)
    assert np.allclose(grams, [half @ half.T for half in halves])
    assert np.allclose(combine_grams(grams, SCALES), grams[0] / 0.25 + grams[1] / 4)


def test_projection_undoes_reconstruction() -> None:
    found = fit(rows(), 4)
    beta = found.sample(1, seed=3)[0]
    features = found.mean + SCALES[:, None] * np.tensordot(beta, found.basis, 1)
    everywhere = np.ones(40, bool)
    assert np.allclose(found.project(features, everywhere), beta, atol=1e-4)
    partly = np.arange(40) % 5 > 0
    features[:, ~partly] = np.nan
    assert np.allclose(found.project(features, partly), beta, atol=1e-4)


def test_too_few_texels_are_refused() -> None:
    with pytest.raises(InputError, match="2 of the model's 40 texels are covered, too few for its"):
        fit(rows()).project(rows()[0].reshape(2, 40), np.arange(40) < 2)


def test_samples_have_the_variances_of_the_components() -> None:
    found = fit(rows())
    sampled = found.sample(20000, seed=1)
    assert np.allclose(sampled.mean(0) / np.sqrt(found.variances), 0, atol=0.03)
    assert np.allclose(sampled.var(0) / found.variances, 1, atol=0.05)
    assert np.array_equal(found.sample(5, seed=1), sampled[:5])
    assert not np.array_equal(found.sample(5, seed=2), sampled[:5])


@pytest.mark.parametrize("asked", [0, -1, 6, 7])
def test_components_that_the_subjects_do_not_span_are_refused(asked: int) -> None:
    with pytest.raises(InputError, match=f"{asked} components were asked for, and 6 subjects span"):
        fit(rows(), asked)


def test_a_repeated_subject_adds_no_component() -> None:
    twice = rows()[[0, 1, 2, 3, 4, 4]]
    assert len(fit(twice).variances) == 4
    with pytest.raises(InputError, match="6 subjects span 4; ask for 1 to 4"):
        fit(twice, 5)


@pytest.mark.parametrize("count", [1, 3])
def test_subjects_that_do_not_differ_are_refused(count: int) -> None:
    with pytest.raises(InputError, match=f"subjects that differ; got {count} that do not"):
        fit(rows()[[0] * count])
