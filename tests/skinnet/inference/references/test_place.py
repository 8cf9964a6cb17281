"""A reference at a place gives balance and exposure, and what is none is refused."""

import math

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, to_uint8
from skinnet.inference import Capture
from skinnet.inference._references.place import read_card, read_place

GREY = (200, 180, 150)


def picture(colour: tuple[int, ...] = GREY) -> np.ndarray:
    pixels = np.full((80, 120, 3), 60, np.uint8)
    pixels[20:60, 30:90] = colour
    return pixels


@pytest.mark.parametrize("place", [(60, 40), (30, 20, 90, 60), [50, 30, 51, 31]])
def test_it_is_the_colour_at_the_place(place: tuple[int, ...]) -> None:
    found = Capture.from_reference(picture(), place)
    assert found.white_balance == pytest.approx(Capture.from_white(GREY).white_balance, abs=1e-3)
    assert found.exposure is None


def test_noise_is_averaged_in_linear_light() -> None:
    rng = np.random.default_rng(0)
    noisy = picture() + rng.normal(0, 8, (80, 120, 3))
    found = Capture.from_reference(noisy.clip(0, 255).round().astype(np.uint8), (30, 20, 90, 60))
    assert found.white_balance == pytest.approx(Capture.from_white(GREY).white_balance, abs=0.01)


def test_a_known_card_is_divided_out() -> None:
    own = np.array((0.6, 0.3, 0.2))
    card = tuple(int(level) for level in to_uint8(linear_to_srgb(own)))
    shown = to_uint8(linear_to_srgb(own * 0.8))
    found = Capture.from_reference(picture(tuple(map(int, shown))), (60, 40), card)
    assert found.white_balance == pytest.approx((0, 0), abs=0.02)
    assert found.exposure == pytest.approx(math.log(0.8), abs=0.02)
    grey = Capture.from_reference(picture(), (60, 40), 0.5)
    assert grey.exposure == pytest.approx(Capture.from_white(GREY, 0.5).exposure, abs=1e-3)


@pytest.mark.parametrize(
    ("colour", "place", "sentence"),
    [
        (
            (255, 250, 240),
            (60, 40),
            r"60,40 in The array is overexposed in 100% .* Choose a darker",
        ),
        ((200, 60, 40), (60, 40), "is coloured: .* Choose something white or grey"),
        ((8, 8, 7), (60, 40), "is too dark"),
        (
            (255, 120, 10),
            (60, 40),
            r"\(255, 120, 10\) at 60,40 in The array is coloured: .* overexposed, too\. Choose",
        ),
        ((255, 120, 10), (60, 30, 95, 50), "is coloured: .* It is overexposed, too"),
        (GREY, (20, 10, 60, 50), "is uneven: a shadow or an edge lies in it"),
        (GREY, (120, 40), r"120,40 is not in The array, which has 120 x 80 pixels"),
        (GREY, (-1, 40), "is not in The array"),
        (GREY, (90, 20, 30, 60), "is not in The array.*the smaller ones of a box first"),
        (GREY, (1, 2, 3), r"\(x, y\) or \(x0, y0, x1, y1\)"),
    ],
)
def test_what_is_no_reference_is_refused(
    colour: tuple[int, ...], place: tuple[int, ...], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        Capture.from_reference(picture(colour), place)


@pytest.mark.parametrize("colour", [(255, 245, 235), (200, 180, 150)])
def test_a_card_that_is_elsewhere_is_named(colour: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=r"has not the colour that was given: .* Check its place"):
        Capture.from_reference(picture(colour), (60, 40), (200, 40, 30))


def test_transparent_pixels_are_refused() -> None:
    pixels = np.dstack([picture(), np.full((80, 120), 200, np.uint8)])
    with pytest.raises(InputError, match="is transparent"):
        Capture.from_reference(pixels, (60, 40))


def test_words_of_the_command_are_read() -> None:
    assert read_place("3,4") == (3, 4) and read_place("1,2,3,4") == (1, 2, 3, 4)
    assert read_card(None).reflectance is None
    assert read_card("0.18").reflectance == 0.18 and read_card("18%").reflectance == 0.18
    assert read_card("230,225,210").levels == (230, 225, 210) == read_card("#e6e1d2").levels


@pytest.mark.parametrize("text", ["1", "1,2,3", "a,b", "1.5,2", ""])
def test_a_place_that_is_none_is_named(text: str) -> None:
    with pytest.raises(InputError, match=f"got {text!r}"):
        read_place(text)


@pytest.mark.parametrize("text", ["2", "0", "grey", "1,2", "300,1,1", "nan", "-5%", "0,0,0"])
def test_a_colour_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="give the share of light that it reflects"):
        read_card(text)
