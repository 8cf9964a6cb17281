"""Pictures without colour are told from colour photographs and from patches of skin."""

import numpy as np
import pytest
from painted_skin import compress_jpeg
from scipy import ndimage
from toned_pictures import TONES, cast, make_colour, to_uint8

from skinnet.errors import InputError
from skinnet.images import Box, find_faces, frame_head, linear_to_srgb, resize, srgb_to_linear
from skinnet.images._colour_content import check_colour, find_tone, find_tone_of_texture

FACE = Box(126, 64, 226, 164)


def find_tone_of_face(photo: np.ndarray) -> str | None:
    faces = find_faces(photo)  # none in a picture of one bit
    face = faces[0].box if faces else FACE
    return find_tone(photo, frame_head(face, photo.shape[1], photo.shape[0]), face)


def find_tone_anywhere(photo: np.ndarray) -> str | None:
    return find_tone(photo, Box(0, 0, photo.shape[1], photo.shape[0]), None)


@pytest.mark.parametrize("quality", [90, 60])
@pytest.mark.parametrize("tone", TONES)
def test_a_toned_face_is_found_in_jpegs(tone: str, quality: int) -> None:
    assert find_tone_of_face(compress_jpeg(TONES[tone](make_colour()), quality)) is not None


@pytest.mark.parametrize("size", [120, 350, 1400])
@pytest.mark.parametrize("quality", [95, 50, 20])
@pytest.mark.parametrize("light", ["as it is", "dark", "bright", "warm", "cold", "faded"])
def test_a_colour_photograph_is_read(light: str, quality: int, size: int) -> None:
    gains = {"dark": 0.15, "bright": 1.6, "warm": (1.15, 1, 0.85), "cold": (0.9, 1, 1.15)}
    photo = to_uint8(255 * linear_to_srgb(srgb_to_linear(make_colour()) * gains.get(light, 1.0)))
    if light == "faded":
        grey = TONES["grey"](photo)
        photo = to_uint8(0.7 * photo + 0.3 * grey)
    photo = compress_jpeg(resize(photo, size, round(size * 6 / 7)), quality)
    left, top, right, bottom = (round(side * size / 350) for side in FACE)
    face = Box(left, top, right, bottom)
    assert find_tone(photo, frame_head(face, photo.shape[1], photo.shape[0]), face) is None
    assert find_tone_anywhere(photo) is None


@pytest.mark.parametrize("skin", [(232, 195, 178), (200, 150, 130), (150, 105, 85), (60, 38, 28)])
def test_patches_of_skin_are_read(skin: tuple[int, int, int]) -> None:
    flat = np.full((90, 120, 3), skin, np.uint8)
    assert find_tone_anywhere(flat) is None
    shading = np.linspace(0.5, 1, 120)[:, None] * srgb_to_linear(flat)
    shaded = to_uint8(255 * linear_to_srgb(shading))
    noise = np.random.default_rng(0).normal(0, 2, flat.shape)
    for patch in (shaded, to_uint8(shaded + noise), compress_jpeg(shaded, 30)):
        assert find_tone_anywhere(patch) is None


def test_the_remedy_for_a_dark_picture_is_a_brighter_one() -> None:
    sepia = TONES["sepia"](make_colour())
    dark = to_uint8(255 * linear_to_srgb(0.03 * srgb_to_linear(sepia)))
    for photo, remedy in ((sepia, "give the colour photo"), (dark, "too dark, give a brighter")):
        box = frame_head(FACE, photo.shape[1], photo.shape[0])
        with pytest.raises(InputError, match=f"There is no colour in a.jpg: .* {remedy}"):
            check_colour(photo, box, FACE, "a.jpg")


def test_cheek_forehead_and_close_up_of_a_photograph_are_read() -> None:
    photo = make_colour()
    for box in (Box(135, 115, 160, 135), Box(160, 75, 195, 90), Box(130, 70, 222, 165)):
        assert find_tone_anywhere(photo[box.slices]) is None


@pytest.mark.parametrize(
    ("tone", "words"),
    [
        ("grey", "grey"),
        ("sepia", "brown"),
        ("cyanotype", "blue"),
        ("night vision", "green"),
        ("magenta cast", "purple"),
    ],
)
def test_the_tone_is_named(tone: str, words: str) -> None:
    toned = TONES[tone](make_colour())
    for found in (find_tone_of_face(toned), find_tone_anywhere(toned)):
        assert found is not None and words in found


@pytest.mark.parametrize("cloth", [(235, 235, 230), (150, 190, 215), (150, 200, 180), (35, 35, 38)])
def test_a_face_behind_a_mask_of_cloth_is_read(cloth: tuple[int, int, int]) -> None:
    photo = make_colour()
    photo[116:170, 132:218] = to_uint8(np.linspace(0.8, 1, 54)[:, None, None] * cloth)
    assert find_tone(photo, frame_head(FACE, 350, 300), FACE) is None


def test_a_grey_wall_is_no_skin() -> None:
    assert find_tone_anywhere(np.full((90, 120, 3), 200, np.uint8)) == "it is grey"
    assert find_tone_anywhere(cast(1.02, 1, 0.98)(make_colour())) is not None


def test_the_error_names_the_picture_and_the_remedy() -> None:
    grey = TONES["grey"](make_colour())
    with pytest.raises(InputError, match=r"no colour in a\.jpg: the skin in it is grey\. Melanin"):
        check_colour(grey, frame_head(FACE, 350, 300), FACE, "a.jpg")
    check_colour(make_colour(), frame_head(FACE, 350, 300), FACE, "a.jpg")


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (3, 2), (40, 3)])
def test_tiny_pictures_are_not_judged(shape: tuple[int, int]) -> None:
    assert find_tone_anywhere(np.full((*shape, 3), (90, 160, 140), np.uint8)) is None


def test_a_dark_even_texture_of_skin_has_no_tone() -> None:
    rng = np.random.default_rng(0)
    light, red = (ndimage.gaussian_filter(rng.normal(0, 1, (256, 256)), 24) for _ in range(2))
    light, red = 8 * light / light.std(), 0.8 * red / red.std()
    skin = (
        np.array([95.0, 62, 48]) + light[..., None] * (1, 0.92, 0.88) + red[..., None] * (1, 0, 0)
    )
    noise = rng.uniform(-0.5, 0.5, skin.shape)
    assert find_tone_of_texture(np.rint(skin + noise).astype(np.uint8)) is None
    toned = np.array([95.0, 62, 48]) + light[..., None] * (1, 0.92, 0.88)
    assert find_tone_of_texture(np.rint(toned + noise).astype(np.uint8)) == "brown (sepia)"
