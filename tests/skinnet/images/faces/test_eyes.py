from pathlib import Path

import numpy as np
import pytest
from face_drawings import SKIN, WHITE, draw_eyes, place_landmarks
from PIL import Image, ImageDraw

from skinnet.images import find_faces, read_photo
from skinnet.images.faces._eyes import _EYES, locate_sclera
from skinnet.images.faces._face_parts import find_face_parts
from skinnet.images.faces._outlines import Patch
from skinnet.images.faces._skin_reference import measure_colours

SKIN_COLOUR = measure_colours(np.array([[SKIN]], np.uint8)).reduce()


def paste(patches: list[Patch], shape: tuple[int, ...]) -> np.ndarray:
    mask = np.zeros(shape[:2], bool)
    for patch in patches:
        mask[patch.box.slices] |= patch.inside
    return mask


def find_sclera(photo: np.ndarray, landmarks: np.ndarray) -> np.ndarray:
    return paste(locate_sclera(photo, landmarks, SKIN_COLOUR), photo.shape)


def test_the_white_is_found_and_nothing_else() -> None:
    landmarks = place_landmarks()
    photo = draw_eyes(landmarks)
    sclera, white = find_sclera(photo, landmarks), (photo == WHITE).all(-1)
    assert not (sclera & ~white).any()
    assert (sclera & white).sum() > 0.4 * white.sum()
    columns = np.nonzero(sclera)[1]
    assert {column < 250 for column in columns} == {True, False}
    assert (abs(columns - 250) > 68).all()  # no caruncle, which is in the inner corner


@pytest.mark.parametrize("white", [SKIN, (170, 90, 90), (30, 25, 24)])
def test_an_eye_without_anything_white_has_no_sclera(white: tuple[int, ...]) -> None:
    landmarks = place_landmarks()
    assert not find_sclera(draw_eyes(landmarks, white), landmarks).any()


def test_a_closed_eye_has_no_sclera() -> None:
    landmarks = place_landmarks()
    photo = draw_eyes(landmarks)
    right = list(_EYES[0].contour)
    landmarks[right, 1] = 100 + 0.15 * (landmarks[right, 1] - 100)
    assert set(np.nonzero(find_sclera(photo, landmarks))[1] > 250) == {True}


@pytest.mark.parametrize(("width", "found"), [(25, True), (22, False)])
def test_eyes_are_at_least_24_pixels_wide(width: int, found: bool) -> None:
    landmarks = place_landmarks()
    size = round(5 * width), round(4 * width)
    photo = np.array(Image.fromarray(draw_eyes(landmarks)).resize(size, Image.Resampling.BOX))
    assert find_sclera(photo, landmarks * np.float32(width / 100)).any() == found


def test_an_eye_that_is_turned_away_has_no_sclera() -> None:
    landmarks = place_landmarks()
    photo = draw_eyes(landmarks)
    left = list(_EYES[1].contour)
    landmarks[left, 0] = 350 + 0.4 * (landmarks[left, 0] - 350)
    assert set(np.nonzero(find_sclera(photo, landmarks))[1] < 250) == {True}


def test_eyes_outside_the_photograph_do_no_harm() -> None:
    landmarks = place_landmarks()
    photo = draw_eyes(landmarks)
    assert not find_sclera(photo, landmarks + np.float32(600)).any()
    cut = np.ascontiguousarray(photo[100:, 150:])
    assert find_sclera(cut, landmarks - np.float32([150, 100])).any()


@pytest.mark.slow
def test_sclera_lies_inside_the_eyes_of_templates(shared_data: Path) -> None:
    inside, found = 0, 0
    for path in sorted((shared_data / "faces" / "london").glob("*.jpg"))[::8]:
        photo = read_photo(path)
        (face,) = find_faces(photo)
        sclera = paste(list(find_face_parts(photo, face).sclera), photo.shape)
        eyes = draw_template_eyes(path.with_suffix(".tem"), photo.shape)
        inside, found = inside + (sclera & eyes).sum(), found + sclera.sum()
        # Linear R/G: sclera is redder than the grey wall, but far less so than skin.
        wall, white, skin = (
            measure_colours(pixels).reduce().red
            for pixels in (photo[20:120, 20:120], photo[sclera], photo[face.box.slices])
        )
        assert white - wall < 0.65 * (skin - wall)
    assert inside > 0.95 * found > 0


def draw_template_eyes(path: Path, shape: tuple[int, ...]) -> np.ndarray:
    """The eyes of a template of the Face Research Lab London Set."""
    lines = path.read_text(encoding="utf-8").splitlines()[1:190]
    points = [tuple(float(number) for number in line.split()[:2]) for line in lines]
    image = Image.new("1", (shape[1], shape[0]))
    draw = ImageDraw.Draw(image)
    for contour in ((18, 19, 20, 21, 22, 30, 29, 28), (23, 24, 25, 26, 27, 33, 32, 31)):
        draw.polygon([points[index] for index in contour], fill=1)
    return np.array(image)
