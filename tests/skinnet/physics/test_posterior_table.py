"""The posterior agrees with skins sampled from the prior, and its table with the sum over nodes."""

import pytest
import torch
from torch import Tensor

from skinnet.physics._posterior_nodes import tabulate_nodes
from skinnet.physics._posterior_table import REACH, PosteriorTable
from skinnet.physics.prior import SkinPrior
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb
from skinnet.physics.specular import R_SURFACE

D = torch.float64
MATRIX, SKIN, PRIOR = (
    load_spectrum_to_srgb("D65", "mean"),
    SkinReflectance(dtype=D),
    SkinPrior(),
)
CAPTURES = [(0.0, 0.0), (0.003, 0.02), (0.01, 0.2)]
"""Standard deviations of the colour and of the white balance."""


def sample(count: int, seed: int, white_balance: float) -> tuple[Tensor, Tensor]:
    """Fractions [2, count] of sampled skins, and their colours without noise."""
    rng = torch.Generator().manual_seed(seed)
    f_mel, f_blood, nuisance, rest = PRIOR.sample(count, rng)
    colours = (SKIN(f_mel, f_blood, nuisance) + rest / (1 - R_SURFACE)) @ MATRIX
    gains = 1 + white_balance * torch.randn(count, 3, generator=rng, dtype=D)
    gains[:, 1] = 1
    return torch.stack([f_mel, f_blood]), colours * gains


def add_noise(colours: Tensor, noise: float) -> Tensor:
    rng = torch.Generator().manual_seed(9)
    return colours + noise * torch.randn(colours.shape, generator=rng, dtype=D)


def make_table(noise: float, white_balance: float) -> PosteriorTable:
    return PosteriorTable(tabulate_nodes(SKIN, MATRIX, PRIOR, noise, white_balance))


@pytest.mark.parametrize(("noise", "white_balance"), CAPTURES)
def test_ninety_percent_intervals_hold_ninety_percent_of_skins(
    noise: float, white_balance: float
) -> None:
    true, colours = sample(6000, 1, white_balance)
    found = make_table(noise, white_balance)(add_noise(colours, noise)).double()
    for k, fraction in ((0, true[0]), (3, true[1])):
        mean, sd = found[k], found[k + 1]
        width = torch.log1p((sd / mean) ** 2)
        z = (fraction.log() - mean.log() + width / 2) / width.sqrt()
        assert 0.87 <= (z.abs() < 1.645).double().mean() <= 0.93
        assert ((fraction - mean) / sd).mean().abs() < 0.1
    assert (found[6] > REACH).double().mean() < 0.005


def test_means_and_deviations_are_those_of_weighted_samples() -> None:
    noise, white_balance = 0.015, 0.03
    true, colours = sample(100_000, 2, white_balance)
    _, observed = sample(60, 3, white_balance)
    observed = add_noise(observed, noise)
    found = make_table(noise, white_balance)(observed).double()
    weights = torch.softmax(-0.5 * torch.cdist(observed, colours) ** 2 / noise**2, 1)
    known = 1 / (weights**2).sum(1) > 500
    assert known.sum() > 50
    for mean, sd, samples in ((found[0], found[1], true[0]), (found[3], found[4], true[1])):
        expected = weights @ samples
        deviation = (weights @ samples**2 - expected**2).sqrt()
        # Each skin's colours are not quite normal.
        bias = ((mean - expected) / deviation).abs()[known]
        assert bias.median() < 0.1 and bias.quantile(0.95) < 0.25
        ratio = (sd / deviation).log().abs()[known]
        assert ratio.median() < 0.05 and ratio.quantile(0.95) < 0.15


@pytest.mark.parametrize(("noise", "white_balance"), CAPTURES)
def test_interpolation_errors_are_small_beside_the_standard_deviation(
    noise: float, white_balance: float
) -> None:
    _, colours = sample(1500, 4, white_balance)
    colours = add_noise(colours, noise)
    nodes = tabulate_nodes(SKIN, MATRIX, PRIOR, noise, white_balance)
    found = PosteriorTable(nodes)(colours).double()
    root = torch.linalg.cholesky(nodes.covariance)
    score = nodes.log_prior - root.diagonal(dim1=-2, dim2=-1).log().sum(-1)
    whitening = torch.linalg.inv(root)
    squared = torch.stack(
        [((whitening @ (c - nodes.colour)[..., None]) ** 2).sum((-2, -1)) for c in colours]
    )
    weights = torch.softmax(score - squared / 2, 1)
    for k, column in ((0, 4), (3, 6)):
        mean = weights @ nodes.moments[:, column]
        sd = (weights @ nodes.moments[:, column + 1] - mean**2).sqrt()
        error = ((found[k] - mean) / sd).abs()
        assert error.quantile(0.99) < 0.05
        assert (found[k + 1] / sd).log().abs().quantile(0.99) < 0.05
    near = squared.amin(1).sqrt() < REACH - 1
    assert (found[6, near] < REACH).all()


def test_no_colours_and_colours_out_of_the_table() -> None:
    table = make_table(0.003, 0.02)
    assert table(torch.empty(0, 3)).shape == (7, 0)
    outside = torch.tensor([[1e5, 1e5, 1e5], [-1e5, 0, 0], [0, 0, 0.9], [0.9, 0, 0], [0, 0.9, 0]])
    found = table(outside)
    assert found.isfinite().all() and (found[6] > REACH).all()


def test_selected_rows_are_those_of_the_whole_table() -> None:
    table, colours = make_table(0.003, 0.02), sample(500, 1, 0.0)[1]
    rows = (1, 4, 6)
    assert torch.equal(table.select(rows)(colours), table(colours)[list(rows)])
    assert table.select(rows)(colours[:0]).shape == (3, 0)
