"""Skin's spectra: the oracle's numbers, the right gradients, and what physics promises."""

from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from skinnet.physics.optics import PRESETS, SkinOptics
from skinnet.physics.reflectance import SkinReflectance, _pigment_packaging
from tests import oracle

UNIT = np.linspace(0, 1, 33)
fraction = st.floats(0, 1)


def grid(dtype: torch.dtype = torch.float64) -> tuple[torch.Tensor, torch.Tensor]:
    unit = torch.tensor(UNIT, dtype=dtype)
    return unit[:, None], unit[None, :]


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_preset_agrees_with_the_oracle(preset: str, dtype: torch.dtype) -> None:
    actual = SkinReflectance(preset, dtype=dtype)(*grid(dtype))
    assert actual.dtype == dtype
    assert actual.numpy() == pytest.approx(
        oracle.reflectance(preset, UNIT[:, None], UNIT[None, :]), abs=1e-6
    )


@given(fraction, fraction, fraction, st.floats(1e-3, 0.1), st.floats(0.01, 1), st.floats(0, 0.01))
def test_changed_constants_agree_with_the_oracle(
    f_mel: float, f_blood: float, f_oxy: float, d_epd: float, d_pd: float, r: float
) -> None:
    optics = SkinOptics.preset("paper", f_oxy=f_oxy, d_epd=d_epd, d_pd=d_pd, r_vessel=r)
    actual = SkinReflectance(optics, dtype=torch.float64)(f_mel, f_blood)
    expected = oracle.reflectance("paper", f_mel, f_blood, f_oxy=f_oxy, d_epd=d_epd, d_pd=d_pd, r=r)
    assert actual.numpy() == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("corner", [(0, 0), (0, 1), (1, 0), (1, 1), (0.05, 0.04)])
def test_gradients_are_right_to_the_corners(preset: str, corner: tuple[float, float]) -> None:
    model = SkinReflectance(preset, dtype=torch.float64)
    f = [torch.tensor([value], dtype=torch.float64, requires_grad=True) for value in corner]
    assert torch.autograd.gradcheck(model, f)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_reflectance_lies_in_unit_interval(preset: str, dtype: torch.dtype) -> None:
    spectra = SkinReflectance(preset, dtype=dtype)(*grid(dtype))
    assert torch.isfinite(spectra).all() and spectra.min() >= 0 and spectra.max() <= 1


@given(
    fraction,
    fraction,
    st.floats(1e-3, 1),
    st.sampled_from(["measured", "calibrated", "paper", "authors"]),
)
def test_more_pigment_is_darker_at_every_band(
    f: float, other: float, step: float, name: str
) -> None:
    model = SkinReflectance(name, dtype=torch.float64)
    more = min(f + step, 1.0)
    assert (model(more, other) <= model(f, other)).all()
    assert (model(other, more) <= model(other, f)).all()


def test_a_little_pigment_is_strictly_darker_at_every_band() -> None:
    model = SkinReflectance(dtype=torch.float64)
    assert (model(0.03, 0.05) < model(0.02, 0.05)).all()
    assert (model(0.03, 0.05) < model(0.03, 0.04)).all()


def test_blood_shows_its_two_valleys_of_oxyhemoglobin() -> None:
    spectrum = SkinReflectance(dtype=torch.float64)(0.02, 0.05).numpy()
    at = dict(zip(oracle.WAVELENGTHS, spectrum, strict=True))
    assert at[540] < at[560] > at[580] and at[580] < at[600]


def test_pigment_packaging_lowers_the_absorption_of_blood() -> None:
    paper, calibrated = (SkinReflectance(name)(0.02, 0.05) for name in ("paper", "calibrated"))
    assert (calibrated > paper).all()


@given(st.lists(st.integers(1, 3), max_size=4), st.data())
def test_any_leading_shape_broadcasts(shape: list[int], data: st.DataObject) -> None:
    model = SkinReflectance(dtype=torch.float64)
    f_mel = torch.rand(shape, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    f_blood = f_mel[tuple(data.draw(st.sampled_from([slice(None), slice(1)])) for _ in shape)]
    spectra = model(f_mel, f_blood)
    assert spectra.shape == (*shape, 33)
    each = [model(float(m), float(b)) for m, b in zip(*_flat(f_mel, f_blood), strict=True)]
    assert torch.allclose(spectra.reshape(-1, 33), torch.stack(each), atol=1e-7)


def _flat(*tensors: torch.Tensor) -> list[torch.Tensor]:
    return [tensor.flatten() for tensor in torch.broadcast_tensors(*tensors)]


def test_an_empty_batch_is_empty() -> None:
    assert SkinReflectance()(torch.rand(0, 4), torch.rand(0, 4)).shape == (0, 4, 33)


def test_state_dict_round_trip(tmp_path: Path) -> None:
    saved, loaded = SkinReflectance(SkinOptics(d_epd=0.03, f_oxy=0.6)), SkinReflectance()
    torch.save(saved.state_dict(), tmp_path / "skin.pt")
    loaded.load_state_dict(torch.load(tmp_path / "skin.pt", weights_only=True))
    f = grid(torch.float32)
    assert torch.equal(loaded(*f), saved(*f)) and not torch.equal(loaded(*f), SkinReflectance()(*f))


@pytest.mark.parametrize("value", [12.3, 1.001, -0.01, float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("name", ["f_mel", "f_blood"])
def test_fraction_out_of_range_is_refused_in_words(name: str, value: float) -> None:
    fractions = {"f_mel": torch.full((2, 3), 0.02), "f_blood": torch.full((2, 3), 0.05)}
    fractions[name][1, 2] = value
    hint = r" Was it given in percent\?" if value > 1 else ""
    sentence = rf"^{name} is a volume fraction in \[0, 1\]; got {value:g}\.{hint}$"
    with pytest.raises(ValueError, match=sentence):
        SkinReflectance()(**fractions)
    with pytest.raises(ValueError, match=sentence):
        SkinReflectance()(**{"f_mel": 0.02, "f_blood": 0.05, name: value})


def test_nothing_is_checked_while_a_graph_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.compiler, "is_compiling", lambda: True)
    assert SkinReflectance()(torch.tensor(float("nan")), torch.tensor(0.05)).isnan().all()


def test_exported_graph_has_no_check_and_the_same_answer() -> None:
    model, f = SkinReflectance(), (torch.rand(2, 3), torch.rand(2, 3))
    program = torch.export.export(model, f, strict=False)
    assert torch.allclose(program.module()(*f), model(*f))
    assert not [node for node in program.graph.nodes if "aminmax" in str(node.target)]


def test_constants_keep_all_digits_in_float64() -> None:
    assert SkinReflectance(dtype=torch.float64).d_epd.item() == 0.014
    exact = oracle.reflectance("measured", 0.1, 0.05)
    actual = SkinReflectance(dtype=torch.float64)(0.1, 0.05)
    assert actual.numpy() == pytest.approx(exact, abs=1e-12)


def tensor(value: float) -> torch.Tensor:
    return torch.tensor([value], dtype=torch.float64)


@pytest.mark.parametrize("x", [0.0, 5e-5, 2e-4, 1.0, 50.0])
def test_pigment_packaging_has_its_value_and_derivatives(x: float) -> None:
    expected = 1.0 if x == 0 else -np.expm1(-x) / x
    assert _pigment_packaging(tensor(x)).item() == pytest.approx(expected, abs=1e-13)
    assert torch.autograd.gradcheck(_pigment_packaging, tensor(x).requires_grad_())
    assert torch.autograd.gradgradcheck(_pigment_packaging, tensor(x).requires_grad_())


def test_pigment_packaging_has_derivative_minus_one_half_at_zero() -> None:
    x = tensor(0.0).requires_grad_()
    (slope,) = torch.autograd.grad(_pigment_packaging(x).sum(), x)
    assert slope.item() == pytest.approx(-0.5)


def test_the_series_of_pigment_packaging_joins_the_closed_form() -> None:
    below, above = (_pigment_packaging(tensor(1e-4 * (1 + sign * 1e-9))) for sign in (-1, 1))
    assert (below - above).abs().item() < 1e-12
