"""Priors are least for what is likely, and have the values of their equations."""

import pytest
import torch
from plain_maps import capture, maps

from skinnet.network import F_MEL_MAX, SkinMaps, priors


def test_shading_from_luminance_ignores_the_level() -> None:
    photograph = torch.full((2, 3, 8, 8), 0.2)
    for level in (0.3, 3.0):
        found = maps(shading=torch.full((2, 8, 8), level))
        assert priors.shading_from_luminance(found, photograph, torch.ones(2, 8, 8)) < 1e-5


def test_priors_grow_with_what_they_penalise() -> None:
    assert priors.camera_prior(capture(camera=1.0)).item() == pytest.approx(0.5)
    assert priors.camera_prior(capture(balance=0.05)).item() == pytest.approx(0.5)
    ones = torch.ones(2, 8, 8)
    assert priors.specular_sparsity(maps(specular=0.2 * ones), ones).item() == pytest.approx(0.2)
    assert priors.off_skin_shading(maps(), 0 * ones) == 1


def test_augmentation_consistency_compares_the_two_halves() -> None:
    seen = SkinMaps(
        *(torch.full((4, 6, 6), value) for value in (0.05, 0.04, 1.0, 0.0)),
        torch.zeros(4, 3, 6, 6),
        torch.ones(4, 6, 6),
    )
    mask = torch.ones(4, 6, 6)
    assert priors.augmentation_consistency(seen, mask) == pytest.approx(0, abs=1e-6)
    other = seen.melanin.clone()
    other[2] = 0.1
    root = (0.1 / F_MEL_MAX) ** (1 / 3) - (0.05 / F_MEL_MAX) ** (1 / 3)
    found = priors.augmentation_consistency(seen._replace(melanin=other), mask)
    assert found == pytest.approx(root / 2, rel=1e-4)
