"""The surface of the instrument's measurement: its limits, one value for each skin, gradients."""

import pytest
import torch

from skinnet.errors import InputError
from skinnet.physics.specular import R_SURFACE, include_specular


def test_black_and_white_are_the_limits() -> None:
    assert include_specular(torch.zeros(33)).tolist() == pytest.approx([R_SURFACE] * 33)
    assert include_specular(torch.ones(33)).tolist() == pytest.approx([1.0] * 33)


def test_without_a_surface_nothing_changes() -> None:
    skin = torch.rand(2, 33, generator=torch.Generator().manual_seed(0))
    assert torch.equal(include_specular(skin, 0.0), skin)


def test_each_skin_has_its_own_surface() -> None:
    skin, surface = torch.full((2, 33), 0.5), torch.tensor([0.0, 0.1])
    found = include_specular(skin, surface)
    assert found[:, 0].tolist() == pytest.approx([0.5, 0.1 + 0.9 * 0.5])


def test_gradients_are_right() -> None:
    skin = torch.tensor([0.0, 0.3, 1.0], dtype=torch.float64, requires_grad=True)
    surface = torch.tensor(0.0, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(include_specular, (skin, surface))


@pytest.mark.parametrize("r_surface", [5.04, -1.0, float("nan")])
def test_a_surface_out_of_range_is_refused(r_surface: float) -> None:
    with pytest.raises(InputError, match=r"r_surface is a reflectance in \[0, 1\]"):
        include_specular(torch.full((33,), 0.5), r_surface)
