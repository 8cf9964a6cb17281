"""Lights by the names that photographers give them."""

import pytest

from skinnet.errors import InputError
from skinnet.inference._light_names import find_light
from skinnet.physics import daylight, load_light


@pytest.mark.parametrize(
    ("name", "light", "kelvin"),
    [
        ("D65", "D", 6503.6), ("d50", "D", 5002.8), ("D5500K", "D", 5500), ("d5500", "D", 5500),
        ("5500 K", "D", 5500), ("daylight", "D", None), ("D", "D", None), ("Flash", "D", 5500),
        ("tungsten", "A", None), ("A", "A", None), (" FL2 ", "FL2", None), ("odd", "odd", None),
    ],
)  # fmt: skip
def test_names_of_lights(name: str, light: str, kelvin: float | None) -> None:
    found = find_light(name)
    assert found[0] == light
    assert found[1] == (None if kelvin is None else pytest.approx(kelvin, abs=0.1))


@pytest.mark.parametrize("name", ["D65", "D50", "D7500K"])
def test_daylight_is_that_of_physics(name: str) -> None:
    import torch

    _, kelvin = find_light(name)
    power = daylight(torch.tensor(kelvin, dtype=torch.float64))
    torch.testing.assert_close(power, load_light(name))


@pytest.mark.parametrize("name", ["D3000K", "2700K", "D30000K", "D10"])
def test_daylight_has_bounds(name: str) -> None:
    with pytest.raises(InputError, match=r"Daylight has 4,000 to 25,000 K; got the light '"):
        find_light(name)
