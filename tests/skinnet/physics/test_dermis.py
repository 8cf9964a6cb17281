"""The reflecting layer: its limits, and its smoothness where a naive form divides zero by zero."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics.dermis import _kubelka_munk_printed, _x_coth_x, kubelka_munk
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
    actual = _kubelka_munk_printed(tensor(k), tensor(s), tensor(d)).numpy()
    assert actual == pytest.approx(expected, abs=1e-9)


@given(scattering, thickness)
def test_layer_without_absorption_reflects_sd_over_one_plus_sd(s: float, d: float) -> None:
    actual = kubelka_munk(tensor(0.0), tensor(s), tensor(d))
    assert actual.item() == pytest.approx(s * d / (1 + s * d), abs=1e-14)


@given(absorption, scattering)
def test_a_thick_layer_reflects_as_an_infinite_one(k: float, s: float) -> None:
    K = (k * (k + 2 * s)) ** 0.5
    actual = kubelka_munk(tensor(k), tensor(s), tensor(1e4))
    assert actual.item() == pytest.approx(s / (k + s + K), abs=1e-5)


def test_misprint_makes_a_thin_layer_without_absorption_a_mirror() -> None:
    k, s, d = tensor(1e-9), tensor(5.0), tensor(0.1)
    assert _kubelka_munk_printed(k, s, d).item() == pytest.approx(1, abs=1e-4)
    assert kubelka_munk(k, s, d).item() == pytest.approx(0.5 / 1.5, abs=1e-6)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_no_layer_overflows(dtype: torch.dtype) -> None:
    k, s, d = (
        torch.tensor(v, dtype=dtype) for v in ([0.0, 1e-30, 1e6], [50.0] * 3, [0.2, 0.2, 10.0])
    )
    reflected = kubelka_munk(k, s, d)
    assert torch.isfinite(reflected).all() and (reflected >= 0).all() and (reflected <= 1).all()


@pytest.mark.parametrize("x2", [0.0, 5e-5, 2e-4, 1.0, 50.0])
def test_x_coth_x_has_its_value_and_derivatives(x2: float) -> None:
    expected = 1.0 if x2 == 0 else x2**0.5 / np.tanh(x2**0.5)
    assert _x_coth_x(tensor(x2)).item() == pytest.approx(expected, abs=1e-14)
    assert torch.autograd.gradcheck(_x_coth_x, tensor(x2).requires_grad_())
    assert torch.autograd.gradgradcheck(_x_coth_x, tensor(x2).requires_grad_())


def test_x_coth_x_has_derivative_one_third_at_zero() -> None:
    x2 = tensor(0.0).requires_grad_()
    (slope,) = torch.autograd.grad(_x_coth_x(x2).sum(), x2)
    assert slope.item() == pytest.approx(1 / 3)


def test_the_series_joins_the_closed_form() -> None:
    below, above = _x_coth_x(tensor(1e-4 * (1 - 1e-9))), _x_coth_x(tensor(1e-4 * (1 + 1e-9)))
    assert (below - above).abs().item() < 1e-12
