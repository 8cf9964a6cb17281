"""The reflecting layer: its limits, and its smoothness where a naive form divides zero by zero."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics.dermis import kubelka_munk, kubelka_munk_printed, x_coth_x
from skinnet.physics.reflectance import packing
from tests import oracle


def tensor(*values: float) -> torch.Tensor:
    return torch.tensor(values, dtype=torch.float64)


absorption = st.floats(1e-3, 1e4)
scattering = st.floats(1.0, 300.0)
thickness = st.floats(1e-3, 10.0)


@given(absorption, scattering, thickness)
def test_layer_agrees_with_the_exponential_form(k: float, s: float, d: float) -> None:
    expected = oracle.kubelka_munk(np.array([k]), np.array([s]), d)
    assert kubelka_munk(tensor(k), tensor(s), tensor(d)).numpy() == pytest.approx(
        expected, abs=1e-9
    )


@given(absorption, scattering, thickness)
def test_misprinted_layer_agrees_with_the_print(k: float, s: float, d: float) -> None:
    expected = oracle.kubelka_munk(np.array([k]), np.array([s]), d, printed=True)
    actual = kubelka_munk_printed(tensor(k), tensor(s), tensor(d)).numpy()
    assert actual == pytest.approx(expected, abs=1e-9)


@given(scattering, thickness)
def test_layer_without_absorption_reflects_sd_over_one_plus_sd(s: float, d: float) -> None:
    actual = kubelka_munk(tensor(0.0), tensor(s), tensor(d))
    assert actual.item() == pytest.approx(s * d / (1 + s * d), abs=1e-14)


@given(absorption, scattering)
def test_thick_layer_reflects_what_a_bottomless_one_does(k: float, s: float) -> None:
    K = (k * (k + 2 * s)) ** 0.5
    actual = kubelka_munk(tensor(k), tensor(s), tensor(1e4))
    assert actual.item() == pytest.approx(s / (k + s + K), abs=1e-5)


def test_misprint_makes_a_thin_layer_without_absorption_a_mirror() -> None:
    k, s, d = tensor(1e-9), tensor(5.0), tensor(0.1)
    assert kubelka_munk_printed(k, s, d).item() == pytest.approx(1, abs=1e-4)
    assert kubelka_munk(k, s, d).item() == pytest.approx(0.5 / 1.5, abs=1e-6)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_no_layer_overflows(dtype: torch.dtype) -> None:
    k, s, d = (
        torch.tensor(v, dtype=dtype) for v in ([0.0, 1e-30, 1e6], [50.0] * 3, [0.2, 0.2, 10.0])
    )
    reflected = kubelka_munk(k, s, d)
    assert torch.isfinite(reflected).all() and (reflected >= 0).all() and (reflected <= 1).all()


@pytest.mark.parametrize("x2", [0.0, 5e-5, 2e-4, 1.0, 50.0])
def test_x_coth_x_has_its_value_and_slopes(x2: float) -> None:
    expected = 1.0 if x2 == 0 else x2**0.5 / np.tanh(x2**0.5)
    assert x_coth_x(tensor(x2)).item() == pytest.approx(expected, abs=1e-14)
    assert torch.autograd.gradcheck(x_coth_x, tensor(x2).requires_grad_())
    assert torch.autograd.gradgradcheck(x_coth_x, tensor(x2).requires_grad_())


def test_x_coth_x_slopes_by_one_third_at_zero() -> None:
    x2 = tensor(0.0).requires_grad_()
    (slope,) = torch.autograd.grad(x_coth_x(x2).sum(), x2)
    assert slope.item() == pytest.approx(1 / 3)


@pytest.mark.parametrize("x", [0.0, 5e-5, 2e-4, 1.0, 50.0])
def test_packing_has_its_value_and_slopes(x: float) -> None:
    expected = 1.0 if x == 0 else -np.expm1(-x) / x
    assert packing(tensor(x)).item() == pytest.approx(expected, abs=1e-13)
    assert torch.autograd.gradcheck(packing, tensor(x).requires_grad_())
    assert torch.autograd.gradgradcheck(packing, tensor(x).requires_grad_())


def test_packing_slopes_by_minus_one_half_at_zero() -> None:
    x = tensor(0.0).requires_grad_()
    (slope,) = torch.autograd.grad(packing(x).sum(), x)
    assert slope.item() == pytest.approx(-0.5)


@pytest.mark.parametrize("function", [x_coth_x, packing])
def test_series_joins_the_closed_form(function: object) -> None:
    assert callable(function)
    below, above = function(tensor(1e-4 * (1 - 1e-9))), function(tensor(1e-4 * (1 + 1e-9)))
    assert (below - above).abs().item() < 1e-12
