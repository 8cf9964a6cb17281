"""Metrics are of all pixels of a data set, however they are divided into batches."""

import numpy as np
import pytest
import torch

from skinnet.network import Reading, SkinMaps, Uncertainty
from skinnet.physics import SpectralCamera
from train.batch import Batch
from train.metrics import ReadingMetrics


def batch_of(count: int, skin: float, seed: int) -> tuple[Reading, Batch]:
    """Random readings of random pictures, of which that share is skin."""
    rng = torch.Generator().manual_seed(seed)

    def maps(mask: torch.Tensor) -> SkinMaps:
        plain = 0.1 * torch.rand(4, count, 8, 8, generator=rng)
        return SkinMaps(*plain, torch.zeros(count, 3, 8, 8), mask)

    guess, mask = torch.rand(2, count, 8, 8, generator=rng)
    mask = (mask < skin).float()
    photograph, made = torch.rand(2, count, 3, 8, 8, generator=rng)
    capture = SpectralCamera().standard((count,))
    reading = Reading(maps(guess), capture, 1.5 * made, Uncertainty(guess, guess, guess[:, 0, :2]))
    return reading, Batch(photograph, mask, maps(mask), capture)


def test_metrics_are_those_of_all_pixels_at_once() -> None:
    parts = [batch_of(count, skin, seed) for seed, (count, skin) in enumerate([(3, 0.9), (1, 0.1)])]
    metrics = ReadingMetrics()
    for reading, batch in parts:
        metrics.update(reading, batch)
    found = {name: metric.compute().item() for name, metric in metrics.metrics.items()}
    guess, truth = (
        np.concatenate([x.melanin[b.mask > 0.5].numpy() for x, b in pairs])
        for pairs in ([(r.maps, b) for r, b in parts], [(b.truth, b) for _, b in parts])
    )
    assert found["melanin"] == pytest.approx(np.sqrt(np.mean((guess - truth) ** 2)), rel=1e-5)
    assert found["melanin_r"] == pytest.approx(np.corrcoef(guess, truth)[0, 1], rel=1e-4)
    assert found["melanin_constant"] == pytest.approx(truth.std(), rel=1e-5)
    masks = [(r.maps.mask > 0.5, b.mask > 0.5) for r, b in parts]
    both, either = (
        sum(int(op(a, b).sum()) for a, b in masks) for op in (torch.logical_and, torch.logical_or)
    )
    assert found["mask_iou"] == pytest.approx(both / either)


def test_photographs_without_truth_have_no_pigment_errors() -> None:
    reading, batch = batch_of(2, 0.5, 0)
    assert set(ReadingMetrics().update(reading, batch)) > {"melanin", "hemoglobin_r"}
    found = ReadingMetrics().update(reading, batch._replace(truth=None, capture=None))
    assert set(found) == {"reconstruction", "mask_iou"}


def test_pictures_without_skin_count_in_the_mask_alone() -> None:
    assert set(ReadingMetrics().update(*batch_of(2, 0.0, 0))) == {"mask_iou"}
