"""CIE daylight: the series of the standard, continuous in its temperature."""

import colour
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics._tables import read_table
from skinnet.physics.illuminants import daylight
from tests import oracle

COMPONENTS = torch.stack(list(read_table("daylight").values()))


def spectrum(temperature: float) -> np.ndarray:
    return daylight(torch.tensor(temperature, dtype=torch.float64), COMPONENTS).numpy()


@given(st.floats(4000, 25000))
def test_daylight_agrees_with_the_oracle(temperature: float) -> None:
    assert spectrum(temperature) == pytest.approx(oracle.daylight(temperature), abs=1e-12)


@pytest.mark.parametrize("temperature", [4000.0, 5003.0, 6504.0, 7000.0, 7500.0, 12000.0, 25000.0])
def test_daylight_agrees_with_colour_science(temperature: float) -> None:
    xy = colour.temperature.CCT_to_xy_CIE_D(temperature)
    reference = colour.sd_CIE_illuminant_D_series(xy, M1_M2_rounding=False)
    power = reference[oracle.WAVELENGTHS]
    assert spectrum(temperature) == pytest.approx(power / power.sum(), abs=1e-6)


@given(st.floats(4000, 25000), st.sampled_from([torch.float32, torch.float64]))
def test_daylight_is_positive_with_unit_sum(temperature: float, dtype: torch.dtype) -> None:
    power = daylight(torch.tensor(temperature, dtype=dtype), COMPONENTS.to(dtype))
    assert power.dtype == dtype and (power > 0).all()
    assert power.sum().item() == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("temperature", [4000.0, 5000.0, 6999.0, 7001.0, 25000.0])
def test_temperature_has_the_right_gradient(temperature: float) -> None:
    kelvin = torch.tensor([temperature / 1000], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda t: daylight(1000 * t, COMPONENTS), kelvin)


def test_gradient_is_finite_at_the_kink() -> None:
    kelvin = torch.tensor([7000.0], dtype=torch.float64, requires_grad=True)
    (slope,) = torch.autograd.grad(daylight(kelvin, COMPONENTS)[..., 0].sum(), kelvin)
    assert torch.isfinite(slope) and slope > 0


def test_the_two_branches_meet() -> None:
    assert spectrum(7000.0) == pytest.approx(spectrum(np.nextafter(7000.0, 8000.0)), rel=1e-4)


def test_colder_light_is_bluer() -> None:
    ratio = [spectrum(t)[5] / spectrum(t)[25] for t in (4000.0, 6000.0, 6999.0, 7001.0, 20000.0)]
    assert ratio == sorted(ratio)


def test_any_leading_shape() -> None:
    kelvin = torch.linspace(4000, 25000, 6, dtype=torch.float64).reshape(2, 3)
    power = daylight(kelvin, COMPONENTS)
    assert power.shape == (2, 3, 33)
    assert torch.equal(power[1, 2], daylight(kelvin[1, 2], COMPONENTS))
