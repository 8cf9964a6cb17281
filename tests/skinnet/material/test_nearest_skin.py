"""The nearest skins of very many colours, against the physics and the exact search."""

import numpy as np
import pytest
import torch
from jaxtyping import Float

from skinnet.images.srgb import linear_to_srgb, srgb_to_linear
from skinnet.material import AlbedoColour
from skinnet.material._nearest_skin import NearestSkin
from skinnet.physics import SkinInverse, SkinPrior, SkinReflectance, load_spectrum_to_srgb

MATRIX = load_spectrum_to_srgb("D65", "observer")


@pytest.fixture(scope="module")
def colour() -> AlbedoColour:
    return AlbedoColour()


@pytest.fixture(scope="module")
def inverse(colour: AlbedoColour) -> SkinInverse:
    return colour.colour.lookup.inverse(MATRIX, (128, 128))


@pytest.fixture(scope="module")
def nearest(colour: AlbedoColour) -> NearestSkin:
    return NearestSkin(colour.colour.lookup, MATRIX)


def sample_people(count: int) -> Float[torch.Tensor, "people 3"]:
    """Colours of people, who differ in more than melanin and blood."""
    f_mel, f_blood, nuisance = SkinPrior().sample(count, torch.Generator().manual_seed(0))[:3]
    return SkinReflectance(dtype=torch.float64).bands(f_mel, f_blood, nuisance) @ MATRIX


@pytest.mark.parametrize("f_mel", [0.01, 0.03, 0.1, 0.2, 0.35])
def test_skin_of_the_model_gives_its_own_fractions_at_16_bits(
    colour: AlbedoColour, f_mel: float
) -> None:
    f_blood = torch.linspace(0.01, 0.12, 23, dtype=torch.float64)
    rgb = SkinReflectance(dtype=torch.float64)(f_mel, f_blood) @ MATRIX
    stored = np.rint(linear_to_srgb(rgb.numpy()) * 65535)
    maps = colour.invert(srgb_to_linear((stored / 65535).astype(np.float32)))
    np.testing.assert_allclose(maps.f_mel, f_mel, rtol=0.01)
    np.testing.assert_allclose(maps.f_blood, f_blood, rtol=0.01)


def test_colours_of_people_get_the_nearest_skin(
    colour: AlbedoColour, nearest: NearestSkin, inverse: SkinInverse
) -> None:
    rgb = sample_people(2000)
    found = nearest(rgb.float(), torch.ones(len(rgb)))
    exact = inverse(rgb)
    for one, other in zip(found, exact[:2], strict=True):
        difference = (one - other).abs().numpy()
        assert np.median(difference) < 2e-5 and np.percentile(difference, 98) < 1e-3
    distance = np.linalg.norm(rgb.numpy() - colour.decode(*found.numpy()), axis=1)
    assert (distance - exact.offset.norm(dim=1).numpy()).max() < 5e-4


def test_maps_do_not_jump_where_skin_ends(colour: AlbedoColour) -> None:
    skin, paint = np.array([0.5, 0.27, 0.18]), np.array([0.1, 0.5, 0.15])
    share = np.linspace(0, 1, 4001)[:, None]
    maps = colour.invert((skin + share * (paint - skin)).astype(np.float32))
    assert maps.skin[0] == 1 and maps.skin[-1] == 0
    assert np.abs(np.diff(maps.f_mel)).max() < 2e-3 and np.abs(np.diff(maps.f_blood)).max() < 2e-3


def test_any_colour_has_fractions_within_the_table(nearest: NearestSkin) -> None:
    generator = torch.Generator().manual_seed(0)
    rgb = 4 * torch.rand(5000, 3, generator=generator) - 1
    for weight in (0.0, 1.0):
        f_mel, f_blood = nearest(rgb, torch.full((len(rgb),), weight))
        assert 0 <= f_mel.min() and f_mel.max() <= 0.4301
        assert 0 <= f_blood.min() and f_blood.max() <= 0.1501
    assert nearest(rgb[:0], torch.zeros(0)).shape == (2, 0)
