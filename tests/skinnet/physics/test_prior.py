"""The prior: scipy's densities, samples with the moments of the record, skins where ISSA's are."""

import colour
import numpy as np
import pytest
import torch
from scipy.stats import multivariate_normal

from benchmarks.skin_spectra import fill_bands, halve_issa, load_issa
from skinnet.errors import InputError
from skinnet.physics import (
    Nuisance,
    SkinPrior,
    SkinReflectance,
    include_specular,
    load_light,
    load_observer,
    spectrum_to_srgb,
)
from tests import oracle

COUNT = 4000


@pytest.fixture(scope="module")
def prior() -> SkinPrior:
    return SkinPrior()


@pytest.fixture(scope="module")
def sampled(prior: SkinPrior) -> tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor]:
    return prior.sample(COUNT, torch.Generator().manual_seed(0))


def test_log_prob_is_scipys(prior: SkinPrior) -> None:
    rng = np.random.default_rng(0)
    for f_mel, f_blood in ((0.03, 0.02), (0.12, 0.05), (0.4, 0.1)):
        values = rng.normal(0, 0.3, 4)
        nuisance = Nuisance(*torch.tensor(values))
        fractions = torch.tensor([f_mel, f_blood], dtype=torch.float64)
        actual = prior.log_prob(*fractions, nuisance)
        expected = _log_mixture(prior, f_mel, f_blood) + _log_nuisance(
            prior, f_mel, f_blood, values
        )
        assert actual.item() == pytest.approx(expected, abs=1e-9)


def _log_mixture(prior: SkinPrior, f_mel: float, f_blood: float) -> float:
    parts = zip(prior.weights.numpy(), prior.means.numpy(), prior.covariances.numpy(), strict=True)
    x = np.log([f_mel, f_blood])
    return float(np.log(sum(w * multivariate_normal.pdf(x, m, S) for w, m, S in parts)))


def _log_nuisance(prior: SkinPrior, f_mel: float, f_blood: float, values: np.ndarray) -> float:
    near = np.exp(-0.5 * ((np.log(f_mel) - prior.tones.numpy()) / prior.width) ** 2)
    covariance = np.tensordot(near / near.sum(), prior.nuisance.numpy(), 1)
    mean = np.array([1, np.log(f_mel / 0.12), np.log(f_blood / 0.045)]) @ prior.coefficients.numpy()
    return float(multivariate_normal.logpdf(values, mean, covariance))


def test_log_prob_has_the_right_gradient(prior: SkinPrior) -> None:
    inputs = [
        torch.tensor([value], dtype=torch.float64, requires_grad=True)
        for value in (0.1, 0.04, -0.2, 0.1, 0.05, 0.0)
    ]
    assert torch.autograd.gradcheck(
        lambda f_mel, f_blood, *rest: prior.log_prob(f_mel, f_blood, Nuisance(*rest)), inputs
    )


def test_log_prob_broadcasts(prior: SkinPrior) -> None:
    f_mel, f_blood = torch.tensor([[0.05], [0.2]]), torch.tensor([0.02, 0.04, 0.06])
    found = prior.log_prob(f_mel, f_blood, Nuisance.zeros())
    assert found.shape == (2, 3)
    one = prior.log_prob(f_mel[1, 0], f_blood[2], Nuisance.zeros())
    assert found[1, 2].item() == pytest.approx(one.item())


def test_densities_sum_to_one(prior: SkinPrior) -> None:
    ln_mel = torch.linspace(-7, 1, 400, dtype=torch.float64)
    ln_blood = torch.linspace(-7, 1, 400, dtype=torch.float64)
    density = prior.log_density(ln_mel[:, None].exp(), ln_blood.exp()).exp()
    assert density.sum().item() * (8 / 399) ** 2 == pytest.approx(1, abs=1e-3)


def test_samples_are_skins_and_repeat(
    prior: SkinPrior, sampled: tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor]
) -> None:
    f_mel, f_blood, nuisance, leftover = sampled
    assert f_mel.min() > 0 and f_mel.max() <= 1 and f_blood.min() > 0 and f_blood.max() <= 1
    assert nuisance.thickness.shape == (COUNT,) and leftover.shape == (COUNT, 33)
    again = prior.sample(COUNT, torch.Generator().manual_seed(0))
    assert torch.equal(again[0], f_mel) and torch.equal(again[3], leftover)


def test_samples_have_the_moments_of_the_mixture(
    prior: SkinPrior, sampled: tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor]
) -> None:
    pigments = torch.stack(sampled[:2], -1).log()
    mean = prior.weights @ prior.means
    spread = prior.means - mean
    covariance = torch.einsum(
        "k,kij->ij", prior.weights, prior.covariances + spread[:, :, None] * spread[:, None]
    )
    error = covariance.diagonal().sqrt() / COUNT**0.5
    assert ((pigments.mean(0) - mean).abs() < 4 * error).all()
    torch.testing.assert_close(torch.cov(pigments.T), covariance, atol=0.03, rtol=0.1)


def test_what_is_sampled_besides_is_normal_given_melanin(
    prior: SkinPrior, sampled: tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor]
) -> None:
    f_mel, f_blood, nuisance, leftover = sampled
    mean, covariance, spread = prior.condition(f_mel, f_blood)
    deviations = torch.stack(nuisance, -1) - torch.stack(mean, -1)
    rest = leftover - prior.leftover_mean(f_mel, nuisance, f_blood)
    for x, S in ((deviations, covariance), (rest, spread)):
        distance = (x * torch.linalg.solve(S, x[..., None])[..., 0]).sum(-1)
        size = x.shape[-1]
        assert distance.mean().item() == pytest.approx(size, abs=5 * (2 * size / COUNT) ** 0.5)


def test_the_leftover_mean_is_linear_in_the_nuisance(prior: SkinPrior) -> None:
    f_mel = torch.tensor([0.05, 0.2], dtype=torch.float64)
    mean, _, _ = prior.condition(f_mel)
    further = [
        prior.leftover_mean(f_mel, mean._replace(thickness=mean.thickness + step))
        for step in (0.0, 0.5, 1.0)
    ]
    torch.testing.assert_close(further[1] - further[0], further[2] - further[1])
    near = torch.exp(-0.5 * ((f_mel.log()[:, None] - prior.tones) / prior.width) ** 2)
    expected = near / near.sum(-1, keepdim=True) @ prior.leftover_means
    torch.testing.assert_close(further[0], expected)
    with_blood = [prior.leftover_mean(f_mel, mean, f_mel.new_tensor(f)) for f in (0.02, 0.04, 0.08)]
    torch.testing.assert_close(with_blood[1] - with_blood[0], with_blood[2] - with_blood[1])


def test_no_blood_given_is_the_typical_one(prior: SkinPrior) -> None:
    f_mel, typical = torch.tensor([0.05, 0.2]).double(), torch.tensor(0.045).double()
    mean, covariance, leftover = prior.condition(f_mel)
    others = prior.condition(f_mel, typical)
    torch.testing.assert_close(torch.stack(mean), torch.stack(others[0]))
    assert torch.equal(covariance, others[1]) and torch.equal(leftover, others[2])
    torch.testing.assert_close(
        prior.leftover_mean(f_mel, mean), prior.leftover_mean(f_mel, mean, typical)
    )


def test_more_blood_goes_with_a_thicker_dermis(prior: SkinPrior) -> None:
    f_mel, f_blood = torch.tensor(0.1), torch.tensor([0.02, 0.08])
    thin, thick = prior.condition(f_mel, f_blood)[0].thickness
    assert thick > thin


def test_typical_thickness_goes_with_blood() -> None:
    nuisance = SkinPrior.typical_nuisance(torch.tensor([0.03, 0.06]))
    assert nuisance.thickness.exp().tolist() == pytest.approx([1.0, 2**1.5])
    assert all(not one.any() for one in nuisance[1:])


def test_fractions_are_those_of_the_literature(
    sampled: tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor],
) -> None:
    f_mel, f_blood = sampled[:2]
    low, high = f_mel.quantile(torch.tensor([0.01, 0.99]).double())
    assert 0.01 < low < 0.05 and 0.25 < high < 0.55
    low, high = f_blood.quantile(torch.tensor([0.25, 0.75]).double())
    assert 0.015 < low and high < 0.075


def test_samples_fall_where_measured_skins_do(
    sampled: tuple[torch.Tensor, torch.Tensor, Nuisance, torch.Tensor],
) -> None:
    f_mel, f_blood, nuisance, leftover = sampled
    skin = SkinReflectance(dtype=torch.float64).bands(f_mel, f_blood, nuisance)
    ours, theirs = (
        compute_lab(include_specular(skin) + leftover),
        compute_lab(fill_bands(load_issa())),
    )
    first, second = (theirs[half] for half in halve_issa())
    assert compute_energy_distance(ours, theirs) <= compute_energy_distance(first, second)


def compute_lab(spectra: torch.Tensor) -> torch.Tensor:
    observer = load_observer()
    rgb = spectra @ spectrum_to_srgb(load_light("D6504K"), observer, observer).double()
    xyz = rgb.numpy() @ oracle.srgb_to_xyz().T
    x, y = oracle.D65[0] / oracle.D65.sum(), oracle.D65[1] / oracle.D65.sum()
    return torch.from_numpy(colour.XYZ_to_Lab(xyz, np.array([x, y])))


def compute_energy_distance(a: torch.Tensor, b: torch.Tensor) -> float:
    """Székely & Rizzo 2013."""
    between, within = torch.cdist(a, b).mean(), torch.cdist(a, a).mean() + torch.cdist(b, b).mean()
    return (2 * between - within).item()


@pytest.mark.parametrize("f_blood", [0.0, -0.1, float("nan")])
def test_skin_without_blood_has_no_typical_thickness(f_blood: float) -> None:
    with pytest.raises(InputError, match="f_blood is a volume fraction above 0"):
        SkinPrior.typical_nuisance(torch.tensor(f_blood))
