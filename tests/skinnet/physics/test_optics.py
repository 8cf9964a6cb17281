"""The constants: every one has a case here, is refused out of its range, and can be trained."""

from dataclasses import FrozenInstanceError, fields
from typing import Any

import pytest
import torch
from torch import nn
from torch.func import functional_call

from skinnet.physics._tables import read_table
from skinnet.physics.optics import PRESETS, SkinOptics
from skinnet.physics.reflectance import SkinReflectance

CHANGED: dict[str, Any] = {
    "c_eum": 60.0,
    "c_phm": 20.0,
    "f_eum": 0.5,
    "c_hem": 120.0,
    "g": 50000.0,
    "f_oxy": 0.6,
    "d_epd": 0.01,
    "d_pd": 0.05,
    "d_base": 0.5,
    "r_vessel": 10e-4,
    "r_melanin": 5e-4,
    "blood_epd": 0.1,
    "base_floor": 0.5,
    "base_scale": 50.0,
    "mie": 1e5,
    "rayleigh": 1e12,
    "eps_eum": 2 * read_table("melanin")["eumelanin"],
    "eps_phm": 2 * read_table("melanin")["pheomelanin"],
    "e_oxy": 0.5 * read_table("hemoglobin")["oxy"],
    "e_deoxy": 0.5 * read_table("hemoglobin")["deoxy"],
}
MEDIANS = {
    "measured": 0.0120,
    "calibrated": 0.0170,
    "paper": 0.036,
    "authors": 0.16,
    "printed": 0.44,
}


def skin(**constants: Any) -> SkinReflectance:
    return SkinReflectance(SkinOptics.preset("authors", **constants), dtype=torch.float64)


def fractions() -> tuple[torch.Tensor, torch.Tensor]:
    return torch.tensor([0.0, 0.04], dtype=torch.float64), torch.tensor([0.0, 0.05]).double()


def test_every_constant_has_a_case() -> None:
    constants = {item.name for item in fields(SkinOptics)} - {"dermis"}
    assert constants == set(CHANGED), "A new constant needs a case in CHANGED."


def test_every_preset_has_a_case() -> None:
    assert set(PRESETS) == set(MEDIANS), "A new preset needs a case here and in the oracle."


@pytest.mark.parametrize("name", CHANGED)
def test_constant_has_an_effect_and_metadata(name: str) -> None:
    item = next(item for item in fields(SkinOptics) if item.name == name)
    low, high = item.metadata["range"]
    assert low < high and item.metadata["unit"] and item.metadata["source"]
    f = fractions()
    assert (skin(**{name: CHANGED[name]})(*f) - skin()(*f)).abs().max() > 1e-4


@pytest.mark.parametrize("name", CHANGED)
def test_constant_is_trainable_with_the_right_gradient(name: str) -> None:
    value = torch.as_tensor(CHANGED[name], dtype=torch.float64)
    model = skin(**{name: nn.Parameter(value)})
    assert [key for key, _ in model.named_parameters()] == [name]
    # In units of the constant itself: a step of 1e-6 is nothing to a scattering of 1e12.
    scale = torch.ones_like(value).requires_grad_()
    assert torch.autograd.gradcheck(
        lambda scale: functional_call(model, {name: value * scale}, fractions()), scale, atol=1e-7
    )


@pytest.mark.parametrize(
    "name", ["r_vessel", "r_melanin", "f_oxy", "blood_epd", "d_epd", "base_floor"]
)
def test_constant_has_a_gradient_where_it_is_zero(name: str) -> None:
    model = skin(**{name: nn.Parameter(torch.zeros((), dtype=torch.float64))})
    zero = torch.zeros((), dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda value: functional_call(model, {name: value}, fractions()),
        zero,
        eps=1e-8,
        atol=1e-4,
        rtol=1e-4,
    )


def test_calibrated_is_paper_with_packaging_of_blood() -> None:
    for item in fields(SkinOptics):
        ours, theirs = (getattr(PRESETS[name], item.name) for name in ("calibrated", "paper"))
        same = torch.equal(ours, theirs) if isinstance(ours, torch.Tensor) else ours == theirs
        assert same != (item.name == "r_vessel"), item.name


def test_measured_is_the_default() -> None:
    f = fractions()
    assert torch.equal(SkinReflectance()(*f), SkinReflectance(PRESETS["measured"])(*f))
    assert torch.equal(SkinReflectance(SkinOptics())(*f), SkinReflectance("measured")(*f))


def test_presets_are_frozen() -> None:
    with pytest.raises(FrozenInstanceError):
        PRESETS["paper"].d_epd = 0.1  # type: ignore[misc]
    with pytest.raises(TypeError):
        PRESETS["paper"] = SkinOptics()  # type: ignore[index]


def test_a_module_does_not_write_into_the_tables() -> None:
    model = SkinReflectance(dtype=torch.float64)
    model.eps_eum.zero_()
    assert read_table("melanin")["eumelanin"].min() > 0


def test_printed_skin_is_black() -> None:
    f_mel, f_blood = torch.linspace(0.01, 0.43, 20), torch.linspace(0.02, 0.07, 10)
    printed = SkinReflectance("printed")(f_mel[:, None], f_blood)
    assert printed.max() < 0.01
    assert SkinReflectance("paper")(f_mel[:, None], f_blood).max() > 0.5


@pytest.mark.parametrize(
    ("name", "value"),
    [("f_oxy", 75.0), ("f_oxy", -0.1), ("d_epd", float("nan")), ("d_pd", 0.0), ("r_vessel", 20.0)],
)
def test_constant_out_of_its_range_is_refused_with_its_value(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=rf"{name} is in .* and lies in \[.*\]; got {value:g}\."):
        SkinOptics.preset("calibrated", **{name: value})
    with pytest.raises(ValueError, match=name):
        SkinOptics(**{name: nn.Parameter(torch.tensor(float(value)))})


def test_unknown_names_are_refused_with_the_known_ones() -> None:
    with pytest.raises(
        ValueError, match=r"no preset 'skin'.*measured, calibrated, paper, authors, printed"
    ):
        SkinReflectance("skin")
    with pytest.raises(ValueError, match=r"no constant f_oxi; it has .*f_oxy"):
        SkinOptics.preset("paper", f_oxi=0.5)
