import numpy as np
import pytest

from skinnet.images import ColourSpace, Picture, srgb_to_linear
from skinnet.images._named_spaces import ADOBE_RGB, DISPLAY_P3

RNG = np.random.default_rng(0)
SPACES = [
    ColourSpace("sRGB", "assumed"),
    ColourSpace("Display P3", "ICC profile", DISPLAY_P3.profile()),
    ColourSpace("Adobe RGB (1998)", "ICC profile", ADOBE_RGB.profile()),
]


def make_pixels(dtype: type, channels: int = 3) -> np.ndarray:
    return RNG.integers(0, np.iinfo(dtype).max, (6, 7, channels), dtype, endpoint=True)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("space", SPACES)
def test_linear_and_back_are_the_same_pixels(space: ColourSpace, dtype: type) -> None:
    picture = Picture("a", make_pixels(dtype), None, space)
    changed = np.ones((6, 7), bool)
    again = picture.with_linear(picture.linear(), changed)
    tolerance = 1 if dtype == np.uint8 else 24
    assert np.abs(again.pixels.astype(int) - picture.pixels).max() <= tolerance
    assert again.colour_space == space and again.pixels.dtype == dtype


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("space", SPACES)
def test_pixels_that_do_not_change_are_kept_exactly(space: ColourSpace, dtype: type) -> None:
    picture = Picture("a", make_pixels(dtype), None, space)
    changed = np.zeros((6, 7), bool)
    changed[2, 3] = True
    edited = picture.with_linear(np.full((6, 7, 3), 0.2), changed)
    np.testing.assert_array_equal(edited.pixels[~changed], picture.pixels[~changed])
    np.testing.assert_allclose(edited.linear()[2, 3], 0.2, atol=0.004)
    assert picture.pixels is not edited.pixels


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_cmyk_without_a_profile_gets_the_wanted_colour(dtype: type) -> None:
    picture = Picture("a", make_pixels(dtype, 4), None, ColourSpace("CMYK", "assumed"))
    wanted = srgb_to_linear(np.array([180, 120, 90], np.uint8))
    edited = picture.with_linear(np.broadcast_to(wanted, (6, 7, 3)), np.ones((6, 7), bool))
    assert edited.pixels.shape == (6, 7, 4) and edited.pixels.dtype == dtype
    assert np.abs(edited.srgb.astype(int) - [180, 120, 90]).max() <= 2


def test_grey_becomes_rgb_in_srgb() -> None:
    grey = make_pixels(np.uint8)[..., 0]
    whole = Picture("a", grey).as_colour()
    np.testing.assert_array_equal(whole.pixels, np.repeat(grey[..., None], 3, 2))
    assert whole.colour_space.name == "sRGB" and whole.as_colour() is whole
