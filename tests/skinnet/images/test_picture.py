from pathlib import Path

import colour
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from picture_files import make_photo

from skinnet.images import ColourSpace, Picture, read_picture
from skinnet.images._icc import SRGB_PRIMARIES, make_profile
from skinnet.images._named_spaces import (
    ADOBE_RGB,
    CODED_PRIMARIES,
    DISPLAY_P3,
    NamedSpace,
    decode_bt709,
    decode_srgb,
    find_coded_space,
    find_space,
)

PROFILES = {
    "sRGB": None,
    "Adobe RGB": ADOBE_RGB.profile(),
    "Display P3": DISPLAY_P3.profile(),
    "linear": make_profile(SRGB_PRIMARIES, 1.0),
}


def make_picture(pixels: np.ndarray, space: str) -> Picture:
    return Picture("a", pixels, colour_space=ColourSpace(space, "assumed", PROFILES[space]))


@pytest.mark.parametrize("space", PROFILES)
@given(
    pixels=hnp.arrays(
        st.sampled_from([np.uint8, np.uint16]), st.tuples(st.just(3), st.just(4), st.just(3))
    )
)
def test_linear_light_comes_back_as_the_same_pixels(space: str, pixels: np.ndarray) -> None:
    picture = make_picture(pixels, space)
    back = picture.with_linear(picture.linear(), np.ones((3, 4), bool)).pixels
    # Little CMS keeps curves of 16 bits; the darkest of them are steep.
    limit = 1 if pixels.dtype == np.uint8 else 100
    assert back.dtype == pixels.dtype
    assert np.abs(back.astype(int) - pixels).max() <= limit


def test_pixels_that_are_not_changed_keep_their_values() -> None:
    pixels = np.random.default_rng(0).integers(0, 65536, (5, 6, 3)).astype(np.uint16)
    picture = make_picture(pixels, "Adobe RGB")
    changed = np.zeros((5, 6), bool)
    changed[2, 3] = True
    edited = picture.with_linear(np.full((5, 6, 3), 0.2), changed).pixels
    np.testing.assert_array_equal(edited[~changed], pixels[~changed])
    np.testing.assert_allclose(edited[2, 3] / 65535, 0.2 ** (256 / 563), atol=1e-3)


def test_alpha_is_kept_and_blended_only_for_display() -> None:
    pixels = np.full((2, 2, 4), 0, np.uint8)
    pixels[0, 0, 3] = 255
    picture = read_picture(pixels)
    assert picture.pixels.shape == (2, 2, 3) and picture.alpha is not None
    assert picture.srgb[0, 0].tolist() == [0, 0, 0]
    assert picture.srgb[1, 1].tolist() == [255, 255, 255]
    assert not picture.linear().any()


def test_a_picture_of_a_path_bears_its_name(tmp_path: Path) -> None:
    from PIL import Image

    path = tmp_path / "a.png"
    Image.fromarray(make_photo()).save(path)
    assert read_picture(path).name == str(path)
    assert read_picture(path, "b").name == "b"


CODED = {
    1: "ITU-R BT.709",
    4: "ITU-R BT.470 - 525",
    5: "ITU-R BT.470 - 625",
    6: "SMPTE C",
    9: "ITU-R BT.2020",
    11: "DCI-P3",
    12: "Display P3",
}


@pytest.mark.parametrize("code", CODED)
def test_coded_primaries_are_those_of_colour_science(code: int) -> None:
    space = colour.RGB_COLOURSPACES[CODED[code]]
    found = CODED_PRIMARIES[code]
    np.testing.assert_allclose(found[1:], space.primaries, atol=0.0015)
    np.testing.assert_allclose(found.white, space.whitepoint, atol=0.0015)


def test_coded_curves_are_those_of_colour_science() -> None:
    pixels = np.linspace(0, 1, 101)
    np.testing.assert_allclose(decode_srgb(pixels), colour.cctf_decoding(pixels), atol=1e-6)
    bt709 = colour.models.oetf_inverse_BT709(pixels)
    np.testing.assert_allclose(decode_bt709(pixels), bt709, atol=1e-6)


def test_stated_primaries_are_recognised_within_rounding() -> None:
    rounded = type(DISPLAY_P3.primaries)(
        *((round(x, 3) + 0.001, round(y, 3)) for x, y in DISPLAY_P3.primaries)
    )
    assert find_space(rounded, 2.2) is DISPLAY_P3
    assert find_space(rounded, 1.0).name == "Display P3 primaries, linear"
    assert find_space(ADOBE_RGB.primaries, 1 / 0.45455) is ADOBE_RGB


def test_unknown_codes_have_no_space() -> None:
    assert find_coded_space(77, 13) is None and find_coded_space(1, 99) is None
    assert isinstance(find_coded_space(9, 8), NamedSpace)
