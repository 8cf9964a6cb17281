"""The settings of colours."""

import pytest

from skinnet.pipeline.calibrate import ColourSettings


@pytest.mark.parametrize(
    ("light", "name"),
    [
        ("daylight", "D65"),
        ("Flash", "D5500K"),
        ("tungsten", "A"),
        ("5500K", "D5500k"),
        ("LED-B3", "LED-B3"),
        ("lamp.csv", "lamp.csv"),
    ],
)
def test_lights_have_the_names_of_photographs(light: str, name: str) -> None:
    settings = ColourSettings(light=light)
    assert settings.light_name == name
    if "." not in light:
        settings.check()
