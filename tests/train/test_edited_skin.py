"""Photographs whose pigments were multiplied are those that the decoder makes of other skin."""

from types import SimpleNamespace

import torch

from skinnet.network import F_MEL_MAX, SkinMaps
from skinnet.physics import SkinDecoder, to_display
from train.edited_skin import edit_skin, multiply_pigments

DECODER = SkinDecoder()


def make_maps() -> SkinMaps:
    torch.manual_seed(0)
    melanin, hemoglobin = 0.02 + 0.1 * torch.rand(2, 8, 8), 0.02 + 0.05 * torch.rand(2, 8, 8)
    shading, specular = 0.5 + 0.5 * torch.rand(2, 8, 8), 0.02 * torch.rand(2, 8, 8)
    return SkinMaps(
        melanin, hemoglobin, shading, specular, torch.zeros(2, 3, 8, 8), torch.ones(2, 8, 8)
    )


def render(maps: SkinMaps) -> torch.Tensor:
    return to_display(DECODER(*maps[:4]))


def make_model(maps: SkinMaps) -> SimpleNamespace:
    capture = DECODER.camera.standard((2,))
    return SimpleNamespace(decoder=DECODER, encode=lambda _: (maps, capture, None))


def test_an_edit_is_the_picture_of_other_skin_and_leaves_the_rest() -> None:
    maps, factors = make_maps(), torch.tensor([[0.5, -0.3], [-0.6, 0.4]])
    mask = torch.ones(2, 8, 8)
    mask[:, :2] = 0
    photograph = render(maps)
    edited = edit_skin.__wrapped__(make_model(maps), photograph, mask, factors)
    expected = render(multiply_pigments(maps, factors))
    torch.testing.assert_close(edited[:, :, 2:], expected[:, :, 2:], rtol=0, atol=2e-3)
    torch.testing.assert_close(edited[:, :, :2], photograph[:, :, :2], rtol=0, atol=1e-5)
    assert (edited - photograph)[:, :, 2:].abs().mean() > 0.02


def test_pigments_are_multiplied_up_to_the_largest_fraction() -> None:
    maps = make_maps()
    more = multiply_pigments(maps, torch.tensor([[0.0, 0.5], [9.0, 0.0]]))
    torch.testing.assert_close(more.melanin[0], maps.melanin[0])
    torch.testing.assert_close(more.hemoglobin[0], maps.hemoglobin[0] * torch.tensor(0.5).exp())
    assert (more.melanin[1] == F_MEL_MAX).all()
