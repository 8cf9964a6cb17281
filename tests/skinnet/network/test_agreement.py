"""Losses of people in two photographs, against hand computations and scipy."""

import math

import numpy as np
import torch
from scipy.stats import norm, t

from skinnet.network import (
    SkinMaps,
    Uncertainty,
    agreement_likelihood,
    colour_prediction,
    measure_skin_colour,
    region_agreement,
)
from skinnet.network.autoencoder import F_MEL_MAX
from skinnet.physics import SkinDecoder

MASK = torch.ones(4, 8, 8)
REGIONS = torch.ones(4, 8, 8, dtype=torch.long)


def make_maps(*melanin: float, hemoglobin: float = 0.05) -> SkinMaps:
    level = torch.tensor(melanin)[:, None, None].expand(-1, 8, 8).clone()
    blood = torch.full_like(level, hemoglobin)
    return SkinMaps(level, blood, level, level, torch.zeros(len(level), 3, 8, 8), level)


def test_regions_agree_relative_to_the_differences_between_people() -> None:
    maps = make_maps(0.02, 0.04, 0.02, 0.08)
    roots = (np.array([0.02, 0.04, 0.02, 0.08]) / F_MEL_MAX) ** (1 / 3)
    ratio = (roots[3] - roots[1]) ** 2 / (roots.var(ddof=1) + 1e-5)
    # The whole skin and its one region are the same; of two people, and of two pigments.
    expected = math.log1p(ratio) / 2 / 2
    found = region_agreement(maps, REGIONS, MASK)
    torch.testing.assert_close(found, torch.tensor(expected).float(), rtol=1e-3, atol=1e-6)


def test_agreement_is_no_better_if_all_people_become_the_same() -> None:
    torch.manual_seed(0)
    roots = 0.4 + 0.1 * torch.rand(12)
    roots[6:] += 0.02 * torch.randn(6)
    found = [
        region_agreement(
            make_maps(*(F_MEL_MAX * (0.4 + scale * (roots - 0.4)) ** 3).tolist()),
            REGIONS[:1].expand(12, -1, -1),
            MASK[:1].expand(12, -1, -1),
        ).item()
        for scale in (1.0, 0.5)
    ]
    assert abs(found[1] / found[0] - 1) < 0.03


def test_unrelated_people_agree_as_little_as_chance() -> None:
    torch.manual_seed(0)
    maps = make_maps(*(0.02 + 0.1 * torch.rand(400)).tolist())
    mask, regions = MASK[:1].expand(400, -1, -1), REGIONS[:1].expand(400, -1, -1)
    same = make_maps(*maps.melanin[:200, 0, 0].tolist(), *maps.melanin[:200, 0, 0].tolist())
    assert region_agreement(maps, regions, mask) > 0.3
    assert region_agreement(same, regions, mask) < 1e-6


def test_a_region_that_is_hidden_in_one_photograph_does_not_count() -> None:
    maps, mask = make_maps(0.02, 0.04, 0.02, 0.08), MASK.clone()
    mask[3] = 0
    assert region_agreement(maps, REGIONS, mask).item() < 1e-6


def test_the_whole_skin_is_compared_besides_its_regions() -> None:
    maps = make_maps(0.02, 0.04, 0.02, 0.04)
    torch.manual_seed(0)
    melanin = maps.melanin.clone()
    melanin[:, 4:] *= torch.tensor([1.0, 1.0, 1.3, 0.8])[:, None, None]  # outside of the region
    regions = REGIONS.clone()
    regions[:, 4:] = 0
    assert region_agreement(maps._replace(melanin=melanin), regions, MASK).item() > 0.02
    assert region_agreement(maps, regions, MASK).item() < 1e-6


def test_hopeless_pairs_pull_less_than_others() -> None:
    values = torch.linspace(0.02, 0.08, 20).repeat(2)
    values[20:] *= 1.1
    values[39] = 0.4
    melanin = values[:, None, None].expand(-1, 8, 8).clone().requires_grad_()
    maps = make_maps(*([0.03] * 40))._replace(melanin=melanin)
    region_agreement(maps, REGIONS[:1].expand(40, -1, -1), MASK[:1].expand(40, -1, -1)).backward()
    assert melanin.grad is not None
    pull = melanin.grad.sum((1, 2)).abs() * values ** (2 / 3)  # of the cube roots
    assert 0 < pull[39] < pull[25:35].max()


def test_the_colour_of_the_other_photograph_is_predicted() -> None:
    decoder, maps = SkinDecoder(), make_maps(0.02, 0.1)
    own = measure_skin_colour(maps, MASK[:2], decoder)
    rgb = decoder(*(one[:, :1, :1] for one in maps[:2]))[..., 0, 0]
    torch.testing.assert_close(own[:, 0], (rgb[:, 0] / rgb[:, 1]).log(), rtol=1e-3, atol=1e-3)
    shift, scale = torch.tensor([0.1, -0.1, 0.2]), torch.tensor([0.2, 0.3, 0.4])
    colour = torch.tensor([[0.5, -0.4, -1.0], [0.9, -0.7, -2.0]])
    found = colour_prediction(maps, MASK[:2], colour, decoder, shift, scale.log())
    other = colour.flip(0).numpy()
    expected = -t(4, (own + shift).numpy(), scale.numpy()).logpdf(other)
    np.testing.assert_allclose(found.item(), expected.mean(), rtol=1e-4)


def test_differences_have_the_sum_of_both_variances() -> None:
    maps = make_maps(0.02, 0.03)
    face = torch.tensor([[0.2, 0.1], [0.3, 0.2]])
    found = agreement_likelihood(maps, Uncertainty(MASK[:2], MASK[:2], face), MASK[:2])
    spread = (face**2).sum(0).sqrt().numpy()
    expected = -norm(0, spread).logpdf([math.log(2 / 3), 0]) - math.log(2 * math.pi) / 2
    np.testing.assert_allclose(found.item(), expected.mean(), rtol=1e-5)
