"""What colours say about melanin and blood, and that they say so where it is nothing."""

import pytest
import torch
from torch import Tensor

from skinnet.errors import InputError
from skinnet.physics._colour_posterior import ColourPosteriors
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.optics import SkinOptics
from skinnet.physics.prior import SkinPrior, _read
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb
from skinnet.physics.specular import R_SURFACE

D = torch.float64
MATRIX = load_spectrum_to_srgb("D65", "mean")
LOOKUP = SkinLookup(SkinReflectance(dtype=D))
SMALL = LOOKUP.inverse(MATRIX, nodes=(8, 8))


def sample_skins(count: int) -> tuple[Tensor, Tensor]:
    """Sampled f_mel, and colours."""
    rng = torch.Generator().manual_seed(0)
    f_mel, f_blood, nuisance, rest = SkinPrior().sample(count, rng)
    spectra = LOOKUP.reflectance(f_mel, f_blood, nuisance) + rest / (1 - R_SURFACE)
    return f_mel, spectra @ MATRIX


def test_a_colour_says_more_about_melanin_than_about_blood() -> None:
    f_mel, rgb = sample_skins(2000)
    found = SMALL.posterior(rgb, noise=0.01)
    skin = found.is_skin
    assert skin.double().mean() > 0.995 and not found.mel_is_prior.any()
    assert (found.f_mel_gain > found.f_blood_gain)[skin].all()
    assert ((found.f_mel - f_mel).abs() < 5 * found.f_mel_sd)[skin].double().mean() > 0.99
    pale, dark = skin & (f_mel < f_mel.quantile(0.2)), skin & (f_mel > f_mel.quantile(0.9))
    assert found.f_blood_gain[pale].median() > 2 * found.f_blood_gain[dark].median()
    shares = [found.blood_is_prior[some].double().mean() for some in (pale, dark)]
    assert shares[1] > 2 * shares[0]
    assert torch.equal(found.blood_is_prior[skin], (found.f_blood_gain < 0.25)[skin])


def test_less_is_known_with_more_noise_or_a_less_known_light() -> None:
    _, rgb = sample_skins(500)
    exact = SMALL.posterior(rgb, noise=0.0, white_balance=0.0)
    for noise, white_balance in ((0.05, 0.0), (0.0, 0.2)):
        found = SMALL.posterior(rgb, noise, white_balance)
        assert found.f_mel_sd.nanmedian() > 1.5 * exact.f_mel_sd.nanmedian()
        assert found.f_mel_gain.nanmedian() < exact.f_mel_gain.nanmedian()
        assert found.f_blood_gain.nanmedian() < exact.f_blood_gain.nanmedian() - 0.1


def test_colours_that_are_no_skins_have_no_posterior() -> None:
    rgb = torch.tensor(
        [[0.2, 0.3, 0.8], [0.2, 0.6, 0.1], [9, 9, 9], [-1, -1, -1], [torch.nan, 0.3, 0.2]]
        + [[torch.inf, 0.3, 0.2], [1e7, 0.3, 0.2], [0.9, 0.1, 0.1], [0.45, 0.29, 0.22]]
    )
    found = SMALL.posterior(rgb)
    assert found.is_skin.tolist() == [False] * 8 + [True]
    for values in found[:6]:
        assert values[:8].isnan().all() and values[8].isfinite()
    assert not found.mel_is_prior[:8].any() and not found.blood_is_prior[:8].any()


@pytest.mark.parametrize("shape", [(), (0,), (7,), (2, 3, 4)])
def test_a_posterior_keeps_axes_and_precision(shape: tuple[int, ...]) -> None:
    for dtype in (torch.float16, torch.float32, D):
        rgb = torch.tensor([0.45, 0.29, 0.22], dtype=dtype).expand(*shape, 3).requires_grad_()
        found = SMALL.posterior(rgb)
        assert all(values.shape == shape and not values.requires_grad for values in found)
        assert found.f_mel.dtype == torch.promote_types(dtype, torch.float32)
        assert found.is_skin.dtype == found.blood_is_prior.dtype == torch.bool


def test_a_posterior_does_not_change_with_the_scale_of_the_table() -> None:
    _, rgb = sample_skins(300)
    twice = LOOKUP.inverse(2 * MATRIX, nodes=(8, 8)).posterior(2 * rgb, noise=0.01)
    for ours, expected in zip(twice[:6], SMALL.posterior(rgb, noise=0.005)[:6], strict=True):
        assert torch.allclose(ours, expected, rtol=1e-3, atol=1e-4, equal_nan=True)


def test_a_table_is_kept_for_the_next_call() -> None:
    inverse = ColourPosteriors(LOOKUP.reflectance, MATRIX)
    own = SkinPrior()
    tables = [inverse.tabulate(0.01, 0.0, prior) for prior in (None, own, None, own)]
    assert tables[0] is tables[2] and tables[1] is tables[3] and tables[0] is not tables[1]


def test_a_skin_that_is_not_the_priors_is_refused() -> None:
    rgb = torch.tensor([0.45, 0.29, 0.22])
    for optics in ("calibrated", "authors", SkinOptics.preset("measured", d_pd=0.1)):
        inverse = SkinLookup(SkinReflectance(optics)).inverse(MATRIX, nodes=(4, 4))
        with pytest.raises(InputError, match=r"preset `measured`; this skin differs in .*d_"):
            inverse.posterior(rgb)
        with pytest.raises(InputError, match="hand in a prior that"):
            inverse.posterior(rgb, prior=SkinPrior())
    assert inverse.posterior(rgb, prior=SkinPrior(_read())).is_skin


def test_black_is_no_skin() -> None:
    assert not SMALL.posterior(torch.tensor([[0.0, 0.0, 0.0], [-0.01, -0.01, -0.01]])).is_skin.any()


def test_a_skin_in_single_precision_is_the_priors() -> None:
    rgb = torch.tensor([0.45, 0.29, 0.22])
    single = SkinLookup(SkinReflectance("measured")).inverse(MATRIX.float(), nodes=(4, 4))
    assert single.posterior(rgb).is_skin


@pytest.mark.parametrize("bad", [-0.1, 2.0, float("nan")])
def test_a_bad_deviation_is_named(bad: float) -> None:
    rgb = torch.tensor([0.45, 0.29, 0.22])
    with pytest.raises(InputError, match=r"noise is a standard deviation in \[0, 0.5\]"):
        SMALL.posterior(rgb, noise=bad)
    with pytest.raises(InputError, match="white_balance is a standard deviation"):
        SMALL.posterior(rgb, white_balance=bad)
    with pytest.raises(InputError, match="linear RGB in floating point"):
        SMALL.posterior(torch.rand(5, 4))
