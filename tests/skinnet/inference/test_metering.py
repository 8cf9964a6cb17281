"""A picture in linear light is read alike at any exposure."""

import io
import math

import numpy as np
import pytest
from raw_files import photograph_picture

from skinnet import Decomposer
from skinnet.images import linear_to_srgb, read_picture, srgb_to_linear, to_uint8
from skinnet.inference import Capture
from skinnet.inference._metering import brighten, find_gain, scale_back, shift_exposure

LINEAR = {"known_linear": np.ones(1, np.float32)}
MASK = np.ones((8, 8), np.float32)


def grey(linear: float) -> np.ndarray:
    return to_uint8(linear_to_srgb(np.full((8, 8, 3), linear)))


@pytest.mark.parametrize(
    ("linear", "gain"), [(0.24, 1), (0.5, 1), (0.06, 4), (0.12, 2), (0.001, 32), (0, 32)]
)
def test_skin_is_brightened_as_in_training(linear: float, gain: float) -> None:
    assert find_gain(grey(linear), MASK, LINEAR) == pytest.approx(gain, rel=0.05)


def test_only_linear_pictures_with_skin_are() -> None:
    unknown = {"known_linear": np.zeros(1, np.float32)}
    for known, mask in (({}, MASK), (unknown, MASK), (LINEAR, 0 * MASK)):
        assert find_gain(grey(0.05), mask, known) == 1


def test_light_is_multiplied() -> None:
    bright = srgb_to_linear(brighten(grey(0.1), 3.0))
    np.testing.assert_allclose(bright, 0.3, rtol=0.02)
    assert (brighten(grey(0.5), 3.0) == 255).all()


def test_what_is_known_of_white_is_brightened_too() -> None:
    known = LINEAR | {"known_exposure": np.float32([-1])}
    assert shift_exposure(known, 4.0)["known_exposure"] == pytest.approx(-1 + math.log(4))
    assert shift_exposure(LINEAR, 4.0) == LINEAR


def test_what_is_relative_to_the_light_is_scaled_back() -> None:
    names = ("melanin", "shading", "specular", "offset")
    scaled = scale_back({name: np.float32([2]) for name in names}, 4.0)
    assert {name: float(value[0]) for name, value in scaled.items()} == (
        {"melanin": 2, "shading": 0.5, "specular": 0.5, "offset": 0.5}
    )


@pytest.mark.slow
@pytest.mark.parametrize("is_raw", [False, True])
def test_a_dark_picture_is_read_as_a_bright_one(is_raw: bool, astronaut: np.ndarray) -> None:
    if is_raw:
        pytest.importorskip("rawpy")
    read = []
    for exposure in (0.5, 0.1):
        linear = exposure * srgb_to_linear(astronaut)
        picture = read_picture(to_uint8(linear_to_srgb(linear)))
        if is_raw:
            picture = read_picture(io.BytesIO(photograph_picture(linear, "Nikon D700")))
        read.append(Decomposer(threads=1)(picture, detail=False, capture=Capture(linear=True)))
    assert read[1].means == pytest.approx(read[0].means, rel=0.03)
    skin = read[0].mask > 0.5
    ratio = read[1].shading[skin].mean() / read[0].shading[skin].mean()
    assert ratio == pytest.approx(0.2, rel=0.05)
    brightness = [
        srgb_to_linear(each.reconstruction)[skin].mean() / exposure
        for each, exposure in zip(read, (0.5, 0.1), strict=True)
    ]
    assert brightness[1] == pytest.approx(brightness[0], rel=0.05)
