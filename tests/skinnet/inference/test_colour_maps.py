"""Maps in colour: the scale is told in full, and 256 colours lose nothing that is seen."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from skinnet import Decomposition
from skinnet.errors import InputError
from skinnet.inference._colour_maps import (
    describe_colour_maps,
    list_colour_maps,
    write_colour_map,
)
from skinnet.inference._colour_scales import SPECULAR


def test_a_pixel_has_the_colour_of_its_value(decomposition: Decomposition, tmp_path: Path) -> None:
    write_colour_map(tmp_path / "a.png", "specular", decomposition, "")
    with Image.open(tmp_path / "a.png") as image:
        assert (
            image.mode == "P" and "linear up to 1 %, then logarithmic" in image.text["colour_scale"]
        )
        found = np.array(image.convert("RGB")).astype(int)
    values, mask = decomposition.specular, decomposition.mask
    assert np.abs(found - SPECULAR.colour(values))[mask > 0.5].max() <= 2
    assert (found[mask <= 0.5] == found[0, 0]).all()


def test_a_scale_can_be_drawn_from_its_description() -> None:
    scale: dict[str, Any] = describe_colour_maps("all")["specular"]
    knee, top = scale["linear_to"], scale["ticks"][-1]
    value = 7.0
    place = (1 + np.log(value / knee)) / (1 + np.log(top / knee))
    colours = [[int(one[at : at + 2], 16) for at in (1, 3, 5)] for one in scale["colours"]]
    stops = np.linspace(0, 1, len(colours))
    drawn = [np.interp(place, stops, channel) for channel in zip(*colours, strict=True)]
    np.testing.assert_allclose(drawn, SPECULAR.colour(np.array(value / 100)), atol=0.5)


def test_another_choice_is_refused() -> None:
    assert list_colour_maps("none") == ()
    with pytest.raises(InputError, match="colour_maps is pigments, all, none; got 'colour'"):
        list_colour_maps("colour")
