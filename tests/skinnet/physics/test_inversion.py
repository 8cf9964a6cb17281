"""Fractions are recovered from their colours, and colours that are not skin are flagged."""

import pytest
import torch
from torch import Tensor, nn

from skinnet.errors import InputError
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE, SkinInverse
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.optics import SkinOptics
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb

D = torch.float64
MATRIX = load_spectrum_to_srgb("D65", "mean")
LOOKUP = SkinLookup(SkinReflectance(dtype=D))
INVERSE = LOOKUP.inverse(MATRIX)


def fractions(count: int, seed: int = 0) -> tuple[Tensor, Tensor]:
    unit = torch.rand(2, count, generator=torch.Generator().manual_seed(seed), dtype=D)
    return F_MEL_RANGE[1] * unit[0], F_BLOOD_RANGE[1] * unit[1]


def colours(f_mel: Tensor, f_blood: Tensor, matrix: Tensor = MATRIX) -> Tensor:
    return LOOKUP.reflectance(f_mel, f_blood) @ matrix


def test_the_range_is_the_encoders() -> None:
    assert F_MEL_RANGE == (0, F_MEL_MAX) and F_BLOOD_RANGE == (0, F_BLOOD_MAX)


@pytest.mark.parametrize("dtype", [D, torch.float32])
def test_fractions_are_recovered(dtype: torch.dtype) -> None:
    f_mel, f_blood = fractions(20_000)
    found = INVERSE(colours(f_mel, f_blood).to(dtype))
    for ours, true in ((found.f_mel, f_mel), (found.f_blood, f_blood)):
        assert ours.dtype == dtype
        error = (ours - true).abs()
        assert error.quantile(0.5) < 1e-6 and error.quantile(0.99) < 1e-5 and error.max() < 1e-4
    assert found.on_manifold.all() and found.offset.abs().max() < 1e-6


@pytest.mark.parametrize("name", ["A", "LED-B3", "D50"])
def test_fractions_are_recovered_under_other_lights_and_a_calibration(name: str) -> None:
    transform = torch.tensor([[1.3, 0.1, 0.0], [0.05, 1.1, 0.1], [0.0, -0.1, 0.9]], dtype=D)
    matrix = load_spectrum_to_srgb(name, "Nikon D200") @ transform.mT
    f_mel, f_blood = fractions(5000, seed=1)
    found = LOOKUP.inverse(matrix)(colours(f_mel, f_blood, matrix))
    for ours, true in ((found.f_mel, f_mel), (found.f_blood, f_blood)):
        assert (ours - true).abs().quantile(0.99) < 1e-5


@pytest.mark.parametrize("preset", ["paper", "authors"])
def test_fractions_are_recovered_with_other_presets(preset: str) -> None:
    lookup = SkinLookup(SkinReflectance(preset, dtype=D))
    f_mel, f_blood = fractions(5000, seed=2)
    found = lookup.inverse(MATRIX)(lookup.reflectance(f_mel, f_blood) @ MATRIX)
    for ours, true in ((found.f_mel, f_mel), (found.f_blood, f_blood)):
        error = (ours - true).abs()
        assert error.quantile(0.5) < 1e-4 and error.quantile(0.99) < 1e-3


def test_without_refinement_the_answer_is_the_nearest_node() -> None:
    inverse = LOOKUP.inverse(MATRIX, nodes=(40, 30))
    rgb = colours(*fractions(500)) + 0.02 * torch.randn(500, 3, dtype=D)
    found = inverse(rgb, refine=False)
    nodes = inverse.colours.reshape(-1, 3)
    nearest = torch.cdist(rgb, nodes, compute_mode="donot_use_mm_for_euclid_dist").argmin(1)
    assert torch.allclose(found.offset, rgb - nodes[nearest], atol=1e-15)
    assert torch.allclose(colours(found.f_mel, found.f_blood), nodes[nearest], atol=1e-12)


@pytest.mark.parametrize("dtype", [D, torch.float32])
@pytest.mark.parametrize("spread", [0.01, 0.3, 1e4])
def test_refinement_reduces_the_distance_and_stays_in_range(
    spread: float, dtype: torch.dtype
) -> None:
    noise = torch.randn(1500, 3, generator=torch.Generator().manual_seed(0), dtype=D)
    rgb = colours(*fractions(1500)) + spread * noise
    rgb = rgb.to(dtype)
    refined, node = INVERSE(rgb), INVERSE(rgb, refine=False)
    assert (refined.offset.norm(dim=-1) <= node.offset.norm(dim=-1) * (1 + 1e-6)).all()
    for fraction, (low, high) in ((refined.f_mel, F_MEL_RANGE), (refined.f_blood, F_BLOOD_RANGE)):
        assert (fraction >= low).all() and (fraction <= high * (1 + 1e-6)).all()


def test_model_plus_offset_is_the_colour() -> None:
    rgb = torch.rand(500, 3, dtype=D) * 1.4 - 0.2
    for refine in (True, False):
        found = INVERSE(rgb, refine)
        again = colours(found.f_mel, found.f_blood) + found.offset
        assert torch.allclose(again, rgb, atol=1e-7)


def test_an_offset_inside_the_range_is_normal_to_the_surface() -> None:
    noise = torch.randn(1000, 3, generator=torch.Generator().manual_seed(0), dtype=D)
    rgb = colours(*fractions(1000)) + 0.01 * noise
    found = INVERSE(rgb)
    inner = (found.f_mel > 0) & (found.f_mel < 0.43) & (found.f_blood > 0) & (found.f_blood < 0.15)
    assert inner.sum() > 100
    f = torch.stack([found.f_mel, found.f_blood])[:, inner].requires_grad_()
    model = LOOKUP.reflectance.bands(*f) @ MATRIX
    gradients = [torch.autograd.grad(c.sum(), f, retain_graph=True)[0] for c in model.unbind(-1)]
    gradient = torch.stack(gradients, -1)
    along = (gradient * found.offset[inner]).sum(-1) / gradient.norm(dim=-1)
    assert along.abs().max() < 1e-5


def test_the_border_is_on_the_manifold_and_colours_beyond_are_not() -> None:
    f_mel = torch.tensor([0.0, 0.0, 0.43, 0.2, 0.2], dtype=D)
    f_blood = torch.tensor([0.02, 0.0, 0.05, 0.0, 0.15], dtype=D)
    border = INVERSE(colours(f_mel, f_blood))
    assert border.on_manifold.all()
    assert torch.allclose(border.f_mel, f_mel, atol=1e-7)
    assert torch.allclose(border.f_blood, f_blood, atol=1e-7)
    beyond = LOOKUP.inverse(MATRIX, f_mel=(0.05, 0.2), f_blood=(0.03, 0.06))
    rgb = colours(*torch.tensor([[0.03, 0.3, 0.1, 0.1], [0.04, 0.04, 0.01, 0.1]], dtype=D))
    found = beyond(rgb)
    assert (found.offset[2:].norm(dim=-1) < 0.02).all() and not found.on_manifold.any()
    assert found.f_mel[0] == 0.05 and found.f_mel[1] == 0.2
    assert found.f_blood[2] == 0.03 and found.f_blood[3] == 0.06


def test_colours_that_are_not_skin_are_flagged() -> None:
    rgb = torch.tensor([[0.2, 0.3, 0.8], [-0.1, -0.2, -0.3], [0.3, 0.3, 0.3], [9, 9, 9]])
    for refine in (True, False):
        found = INVERSE(rgb, refine)
        assert not found.on_manifold.any() and found.offset.isfinite().all()
    assert INVERSE(rgb, tolerance=100.0).on_manifold[2]


@pytest.mark.parametrize("refine", [True, False])
def test_damaged_colours_give_nan_and_do_not_change_the_others(refine: bool) -> None:
    rgb = colours(*fractions(6)).float()
    expected = INVERSE(rgb[3:], refine)
    rgb[0, 1], rgb[1, 0], rgb[2, 2] = torch.nan, torch.inf, -1e7
    found = INVERSE(rgb, refine)
    assert not found.on_manifold[:3].any() and found.offset[:3].isnan().all()
    assert found.f_mel[:3].isnan().all() and found.f_blood[:3].isnan().all()
    assert all(torch.equal(a[3:], b) for a, b in zip(found, expected, strict=True))


@pytest.mark.parametrize("shape", [(), (0,), (7,), (2, 3, 4)])
def test_leading_axes_are_kept(shape: tuple[int, ...]) -> None:
    found = INVERSE(torch.rand(*shape, 3))
    assert found.f_mel.shape == found.f_blood.shape == found.on_manifold.shape == shape
    assert found.offset.shape == (*shape, 3) and found.on_manifold.dtype == torch.bool


def test_a_permuted_image_is_inverted_correctly() -> None:
    rgb = torch.rand(3, 5, 6)
    expected = INVERSE(rgb.permute(1, 2, 0).contiguous())
    assert torch.equal(INVERSE(rgb.permute(1, 2, 0)).offset, expected.offset)


def test_half_precision_gives_single_precision() -> None:
    rgb = colours(*fractions(10)).half().requires_grad_()
    assert INVERSE(rgb).f_mel.dtype == torch.float32 and not INVERSE(rgb).f_mel.requires_grad


def test_a_trainable_constant_is_used_and_not_changed() -> None:
    constant = nn.Parameter(torch.tensor(0.03))
    lookup = SkinLookup(SkinReflectance(SkinOptics.preset("measured", d_epd=constant)))
    inverse = lookup.inverse(MATRIX.float().requires_grad_())
    exact = lookup.reflectance(0.1, 0.05) @ MATRIX.float()
    found = inverse(exact)
    assert found.f_mel.item() == pytest.approx(0.1, abs=1e-5)
    assert found.f_blood.item() == pytest.approx(0.05, abs=1e-5)
    assert lookup.reflectance.d_epd is constant and constant.dtype == torch.float32


@pytest.mark.parametrize("rgb", [torch.rand(5, 4), torch.rand(3, 8, 8), torch.zeros(4, 3).byte()])
def test_an_input_without_colours_is_named(rgb: Tensor) -> None:
    with pytest.raises(
        InputError, match="linear RGB in floating point, with R, G and B in the last"
    ):
        INVERSE(rgb)


@pytest.mark.parametrize("bad", [(0.2, 0.1), (-0.1, 0.3), (1.0, 43.0), (float("nan"), 0.5)])
def test_a_bad_range_is_named(bad: tuple[float, float]) -> None:
    with pytest.raises(InputError, match=r"range of f_mel is two volume fractions.*in percent\?"):
        LOOKUP.inverse(MATRIX, f_mel=bad)
    with pytest.raises(InputError, match="range of f_blood"):
        LOOKUP.inverse(MATRIX, f_blood=bad)


def test_a_bad_table_or_matrix_is_named() -> None:
    with pytest.raises(InputError, match="at least 2 nodes of f_blood; got 1"):
        LOOKUP.inverse(MATRIX, nodes=(256, 1))
    for matrix in (MATRIX * torch.nan, MATRIX * 0):
        with pytest.raises(InputError, match="check its light"):
            LOOKUP.inverse(matrix)


@pytest.mark.parametrize("nodes", [(2, 2), (3, 200), (16, 16)])
def test_a_coarse_table_still_finds_its_nodes(nodes: tuple[int, int]) -> None:
    inverse = LOOKUP.inverse(MATRIX, nodes)
    found = inverse(inverse.colours)
    assert isinstance(inverse, SkinInverse) and found.offset.abs().max() < 1e-12
