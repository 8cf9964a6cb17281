"""The posterior of skins from a colour covers what the prior samples, and keeps the colour."""

import pytest
import torch

from benchmarks.recovered_spectra import (
    FittedSkin,
    SkinNodes,
    compute_interval,
    load_d65_matrix,
    make_exact,
)
from benchmarks.whole_spectra import fit_skins
from skinnet.physics import Nuisance, SkinOptics, SkinPrior
from skinnet.physics.specular import R_SURFACE

COUNT = 400


@pytest.fixture(scope="module")
def skin() -> FittedSkin:
    return FittedSkin(SkinOptics(), R_SURFACE, SkinPrior())


@pytest.fixture(scope="module")
def sample(skin: FittedSkin) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    rng = torch.Generator().manual_seed(0)
    f_mel, f_blood, nuisance, leftover = skin.prior.sample(COUNT, rng)
    return f_mel, f_blood, skin.predict(f_mel, f_blood, nuisance) + leftover


def test_intervals_of_colours_hold_the_skins_that_made_them(
    skin: FittedSkin, sample: tuple[torch.Tensor, torch.Tensor, torch.Tensor]
) -> None:
    f_mel, f_blood, spectra = sample
    nodes = SkinNodes(skin)
    posterior = nodes.infer(spectra @ load_d65_matrix())
    for truth, axis, weights in (
        (f_mel, nodes.f_mel, posterior.f_mel),
        (f_blood, nodes.f_blood, posterior.f_blood),
    ):
        low, high = compute_interval(axis, weights)
        inside = ((low <= truth) & (truth <= high)).double().mean().item()
        assert inside == pytest.approx(0.9, abs=3 * (0.09 / COUNT) ** 0.5)


def test_recovered_spectra_beat_the_nearest_of_many_samples(
    skin: FittedSkin, sample: tuple[torch.Tensor, torch.Tensor, torch.Tensor]
) -> None:
    *_, spectra = sample
    matrix = load_d65_matrix()
    recovered = SkinNodes(skin).infer(spectra @ matrix).spectra
    f_mel, f_blood, nuisance, leftover = skin.prior.sample(20000, torch.Generator().manual_seed(1))
    others = skin.predict(f_mel, f_blood, nuisance) + leftover
    nearest = others[torch.cdist(spectra @ matrix, others @ matrix).argmin(1)]
    ours, theirs = ((each - spectra).square().mean() for each in (recovered, nearest))
    # A posterior's sample has twice the squared error of its mean.
    assert ours.item() == pytest.approx(theirs.item() / 2, rel=0.15)


def test_correction_makes_the_colour_exact(
    skin: FittedSkin, sample: tuple[torch.Tensor, torch.Tensor, torch.Tensor]
) -> None:
    rgb = sample[2][:50] @ load_d65_matrix()
    spectra = SkinNodes(skin).infer(rgb).spectra
    assert (spectra @ load_d65_matrix() - rgb).abs().max() < 1e-3
    exact = make_exact(spectra, rgb)
    assert torch.allclose(exact @ load_d65_matrix(), rgb, atol=1e-12)
    assert (exact - spectra).abs().max() < 1e-3


def test_an_interval_is_the_quantiles_of_its_density() -> None:
    nodes = torch.logspace(-3, 0, 301, dtype=torch.float64)
    normal = torch.exp(-0.5 * ((nodes.log() + 3) / 0.4) ** 2)[None]
    low, high = compute_interval(nodes, normal / normal.sum())
    assert low.log().item() == pytest.approx(-3 - 0.4 * 1.645, abs=2e-3)
    assert high.log().item() == pytest.approx(-3 + 0.4 * 1.645, abs=2e-3)


def test_fit_of_a_whole_spectrum_is_the_most_probable_skin(
    skin: FittedSkin, sample: tuple[torch.Tensor, torch.Tensor, torch.Tensor]
) -> None:
    target = sample[2][:20].clone()
    target[::2, -2:] = torch.nan
    best = fit_skins(skin, target).skins

    def log_posterior(z: torch.Tensor) -> torch.Tensor:
        f_mel, f_blood, *nuisance = z.unbind(-1)
        f_mel, f_blood, nuisance = f_mel.exp(), f_blood.exp(), Nuisance(*nuisance)
        _, _, noise = skin.prior.condition(f_mel)
        residual = target - skin.predict(f_mel, f_blood, nuisance)
        residual = residual - skin.prior.leftover_mean(f_mel, nuisance, f_blood)
        known = ~target.isnan()
        likelihood = [
            torch.distributions.MultivariateNormal(
                torch.zeros(int(k.sum())).double(), n[k][:, k]
            ).log_prob(r[k])
            for r, n, k in zip(residual, noise, known, strict=True)
        ]
        return torch.stack(likelihood) + skin.prior.log_prob(f_mel, f_blood, nuisance)

    here = log_posterior(best)
    for step in torch.eye(6).double() * 0.02:
        for sign in (-1, 1):
            assert (log_posterior(best + sign * step) < here + 1e-3).all()
    assert (best[:, 0] - sample[0][:20].log()).abs().median() < 0.05
