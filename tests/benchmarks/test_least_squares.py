"""Bounded least squares finds what was rendered, with bands missing or not."""

import pytest
import torch

from benchmarks.least_squares import compute_rmse, fit, summarise
from skinnet.physics import SkinReflectance


@pytest.mark.parametrize("missing", [0, 5])
def test_fit_finds_what_was_rendered(missing: int) -> None:
    model = SkinReflectance(dtype=torch.float64).bands
    rng = torch.Generator().manual_seed(0)
    truth = torch.rand(20, 2, generator=rng, dtype=torch.float64) * torch.tensor([0.6, 0.3])
    truth[0], truth[1] = torch.tensor([0.0, 0.3]), torch.tensor([0.01, 0.0])
    target = model(*truth.T)
    target[::2, 33 - missing :] = torch.nan
    assert torch.allclose(fit(model, target), truth, atol=1e-6)


def test_missing_bands_do_not_count() -> None:
    target = torch.tensor([[0.1, 0.2, torch.nan], [0.1, 0.2, 0.3]])
    errors = compute_rmse(torch.tensor([0.2, 0.3, 9.0]), target)
    assert torch.allclose(
        errors, torch.tensor([0.1, (0.02 + 8.7**2) / 3]) ** torch.tensor([1, 0.5])
    )


def test_a_summary_has_median_and_95th_percentile() -> None:
    assert summarise(torch.arange(101.0)) == {"median": 50.0, "p95": 95.0}
