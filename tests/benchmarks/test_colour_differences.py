"""Colours by colour-science: white, agreement with our own path, and differences."""

import pytest
import torch

from benchmarks.colour_differences import (
    LIGHTS,
    compute_differences,
    compute_lab,
    compute_typology_angles,
)
from benchmarks.recovered_spectra import load_d65_matrix
from benchmarks.skin_spectra import fill_bands, load_forearms, load_issa
from benchmarks.typology import compute_typology_angle, srgb_to_lab


@pytest.mark.parametrize("light", ["D65", *LIGHTS])
def test_the_perfect_diffuser_is_white(light: str) -> None:
    lab = compute_lab(torch.ones(1, 33, dtype=torch.float64), light)
    assert torch.allclose(lab, torch.tensor([[100.0, 0.0, 0.0]]).double(), atol=1e-6)


def test_skin_has_the_colours_of_our_own_path() -> None:
    skin = fill_bands(torch.cat([load_forearms(), load_issa()]))
    rgb = skin @ load_d65_matrix()
    assert (compute_lab(skin) - srgb_to_lab(rgb)).abs().max() < 0.2
    assert (compute_typology_angles(skin) - compute_typology_angle(rgb)).abs().max() < 0.5


def test_differences_are_zero_for_equal_spectra_alone() -> None:
    skin = load_forearms()[:5]
    assert torch.equal(compute_differences(skin, skin), torch.zeros(5, 3).double())
    assert (compute_differences(1.02 * skin, skin) > 0.2).all()
