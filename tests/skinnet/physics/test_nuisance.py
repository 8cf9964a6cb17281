"""Nuisance: the oracle's spectra, right gradients to the edges, and the limits of physics."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.errors import InputError
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.reflectance import SkinReflectance
from tests import oracle

fraction = st.floats(0, 1)
deviation = st.tuples(st.floats(-2, 2), st.floats(-1, 1), st.floats(-0.5, 0.5), st.floats(-1, 1))


def skin() -> SkinReflectance:
    return SkinReflectance(dtype=torch.float64)


def make(values: tuple[float, ...]) -> Nuisance:
    return Nuisance(*(torch.tensor(value, dtype=torch.float64) for value in values))


@given(fraction, fraction, deviation)
def test_spectra_agree_with_the_oracle(
    f_mel: float, f_blood: float, values: tuple[float, ...]
) -> None:
    actual = skin()(f_mel, f_blood, make(values))
    expected = oracle.reflectance_of_one(f_mel, f_blood, values)
    assert actual.numpy() == pytest.approx(expected, abs=1e-10)


def test_no_deviation_is_the_preset() -> None:
    f_mel = torch.linspace(0, 1, 7, dtype=torch.float64)
    zeros = Nuisance.zeros((7,), like=f_mel)
    torch.testing.assert_close(skin()(f_mel, 0.04, zeros), skin()(f_mel, 0.04))
    assert zeros.thickness.dtype == torch.float64 and zeros.baseline.shape == (7,)
    assert Nuisance.zeros().thickness.dtype == torch.float32


@pytest.mark.parametrize("corner", [(0, 0), (0, 1), (1, 0), (1, 1), (0.05, 0.04)])
@pytest.mark.parametrize(
    "values", [(0.0, 0.0, 0.0, 0.0), (-3.0, 1.0, 0.3, -1.0), (3.0, -1, -0.6, 1)]
)
def test_gradients_are_right_to_the_edges(
    corner: tuple[float, float], values: tuple[float, ...]
) -> None:
    model = skin()
    inputs = [
        torch.tensor([value], dtype=torch.float64, requires_grad=True)
        for value in (*corner, *values)
    ]

    def bands(f_mel: torch.Tensor, f_blood: torch.Tensor, *nuisance: torch.Tensor) -> torch.Tensor:
        return model.bands(f_mel, f_blood, Nuisance(*nuisance))

    assert torch.autograd.gradcheck(bands, inputs)


def test_oxygenation_is_clipped_to_a_share() -> None:
    full, beyond = (make((0, 0, value, 0)) for value in (1 - skin().f_oxy.item(), 0.9))
    torch.testing.assert_close(skin()(0.05, 0.04, beyond), skin()(0.05, 0.04, full))


@given(fraction, fraction, deviation)
def test_reflectance_lies_in_the_unit_interval(
    f_mel: float, f_blood: float, values: tuple[float, ...]
) -> None:
    spectrum = skin()(f_mel, f_blood, make(values))
    assert torch.isfinite(spectrum).all() and spectrum.min() >= 0 and spectrum.max() <= 1


@given(fraction, fraction, st.floats(1e-3, 1), deviation)
def test_more_pigment_is_darker_whatever_the_nuisance(
    f: float, other: float, step: float, values: tuple[float, ...]
) -> None:
    more, nuisance = min(f + step, 1.0), make(values)
    assert (skin()(more, other, nuisance) <= skin()(f, other, nuisance)).all()
    assert (skin()(other, more, nuisance) <= skin()(other, f, nuisance)).all()


def test_a_thick_dermis_is_that_of_infinite_depth() -> None:
    thick = skin().dermis_reflectance(
        torch.tensor([0.04], dtype=torch.float64), Nuisance(*(make((6, 0, 0, 0))))
    )
    c = oracle.MEASURED
    base = oracle.baseline(c["floor"], c["scale"])
    k = 0.04 * skin().mu_blood.numpy() + 0.96 * base
    ratio = k / oracle.scattering(c["mie"], c["rayleigh"])
    assert thick.numpy() == pytest.approx(1 + ratio - np.sqrt(ratio**2 + 2 * ratio), abs=1e-9)


def test_a_thin_dermis_is_black_and_reflects_s_d() -> None:
    model, thin = skin(), make((-12, 0, 0, 0))
    d = model.d_pd.item() * np.exp(-12)
    s = oracle.scattering(oracle.MEASURED["mie"], oracle.MEASURED["rayleigh"])
    found = model.dermis_reflectance(torch.tensor([0.04], dtype=torch.float64), thin)
    assert found.numpy() == pytest.approx(s * d, rel=1e-2)


def test_without_pigment_more_scattering_and_less_baseline_are_brighter() -> None:
    bare = skin()(0.0, 0.0)
    assert (skin()(0.0, 0.0, make((0, 0.5, 0, 0))) > bare).all()
    assert (skin()(0.0, 0.0, make((0, 0, 0, -0.5))) > bare).all()
    assert torch.equal(skin()(0.0, 0.0, make((0, 0, 0.2, 0))), bare)  # no blood to carry oxygen


def test_all_pigment_is_nearly_black_at_short_wavelengths() -> None:
    assert skin()(1.0, 1.0, make((2, 1, 0, -1)))[:10].max() < 1e-3


@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_nuisance_broadcasts_with_fractions(shape: tuple[int, ...]) -> None:
    f_mel = torch.full((2, 1), 0.05, dtype=torch.float64)
    nuisance = Nuisance.zeros(shape, like=f_mel)._replace(thickness=f_mel.new_tensor(0.1))
    expected = torch.broadcast_shapes(f_mel.shape, shape)
    assert skin()(f_mel, 0.04, nuisance).shape == (*expected, 33)


@pytest.mark.parametrize(
    ("name", "value"),
    [("oxygenation", 75.0), ("thickness", float("nan")), ("scattering", 1e3), ("baseline", -1e4)],
)
def test_deviations_beyond_any_skin_are_refused(name: str, value: float) -> None:
    nuisance = Nuisance.zeros()._replace(**{name: torch.tensor(value)})
    with pytest.raises(InputError, match=rf"{name} is a deviation from the preset in"):
        SkinReflectance()(0.05, 0.04, nuisance)
