import numpy as np
import pytest
from face_drawings import RED, SKIN, WHITE, draw_mouth, place_landmarks
from PIL import Image

from skinnet.images.faces._mesh_outlines import INNER_LIPS
from skinnet.images.faces._skin_reference import measure_colours
from skinnet.images.faces._teeth import locate_teeth

SKIN_COLOUR = measure_colours(np.array([[SKIN]], np.uint8)).reduce()


def find_teeth(photo: np.ndarray, landmarks: np.ndarray) -> np.ndarray:
    mask = np.zeros(photo.shape[:2], bool)
    for patch in locate_teeth(photo, landmarks, SKIN_COLOUR):
        mask[patch.box.slices] |= patch.inside
    return mask


def test_teeth_are_found_and_nothing_else() -> None:
    landmarks = place_landmarks()
    photo = draw_mouth(landmarks)
    teeth, white = find_teeth(photo, landmarks), (photo == WHITE).all(-1)
    assert not (teeth & ~white).any()
    assert (teeth & white).sum() > 0.9 * white.sum()


@pytest.mark.parametrize("colour", [RED, SKIN, (25, 20, 20)])
def test_a_mouth_without_teeth_has_none(colour: tuple[int, ...]) -> None:
    landmarks = place_landmarks()
    assert not find_teeth(draw_mouth(landmarks, colour), landmarks).any()


def test_a_closed_mouth_has_no_teeth() -> None:
    landmarks = place_landmarks()
    photo = draw_mouth(landmarks)
    lips = list(INNER_LIPS)
    landmarks[lips, 1] = 300 + 0.1 * (landmarks[lips, 1] - 300)
    assert not find_teeth(photo, landmarks).any()


@pytest.mark.parametrize(("width", "found"), [(26, True), (22, False)])
def test_mouths_are_at_least_24_pixels_wide(width: int, found: bool) -> None:
    landmarks = place_landmarks()
    size = round(500 * width / 120), round(400 * width / 120)
    photo = np.array(Image.fromarray(draw_mouth(landmarks)).resize(size, Image.Resampling.BOX))
    assert find_teeth(photo, landmarks * np.float32(width / 120)).any() == found
