"""Photographs as if by another photographer."""

import numpy as np
import torch
from torch.utils.data import default_collate

from train.rephotography import reframe, rephotograph, sample_rephotography


def test_changes_are_neutral_on_average_and_some_photographs_stay() -> None:
    rng = np.random.default_rng(0)
    changes = default_collate([sample_rephotography(rng) for _ in range(600)])
    kept = (changes.gain == 1).all(1)
    assert 0.2 < kept.float().mean() < 0.3
    log = changes.gain.log()
    assert (log.mean(0).abs() < 0.03).all()
    assert changes.processing.saturation.mean().abs() < 0.06


def test_an_unchanged_photograph_is_the_same_and_others_differ() -> None:
    rng = np.random.default_rng(1)
    changes = default_collate([sample_rephotography(rng) for _ in range(16)])
    torch.manual_seed(0)
    photograph = torch.rand(16, 3, 16, 16)
    seen = rephotograph(changes, photograph)
    kept = (changes.gain == 1).all(1)
    assert 0 < kept.sum() < 16
    torch.testing.assert_close(seen[kept], photograph[kept], rtol=0, atol=2e-5)
    assert ((seen - photograph)[~kept].abs().amax((1, 2, 3)) > 0.01).all()
    assert 0 <= seen.min() and seen.max() <= 1


def test_framing_moves_all_layers_alike_and_regions_stay_numbers() -> None:
    rng = np.random.default_rng(2)
    changes = default_collate([sample_rephotography(rng) for _ in range(8)])
    ramp = torch.linspace(0, 1, 64).expand(8, 1, 64, 64)
    layers = torch.cat([ramp, ramp.mT], 1)
    moved = reframe(changes, layers)
    numbers = reframe(changes, (layers * 4).round(), nearest=True)
    assert (numbers == numbers.round()).all()
    middle = (slice(None), slice(None), slice(16, 48), slice(16, 48))
    assert (numbers - 4 * moved)[middle].abs().max() < 0.65
    slope = (moved[middle][..., 1:] - moved[middle][..., :-1]).mean((-2, -1)) * 63
    cosine, sine = changes.framing[:, 0, 0], changes.framing[:, 1, 0]
    torch.testing.assert_close(slope, torch.stack([cosine, sine], 1), rtol=0, atol=0.03)
    assert 0.02 < changes.framing[:, :, 2].std() < 0.12
