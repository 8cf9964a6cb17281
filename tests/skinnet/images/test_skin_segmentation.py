from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from skinnet.images import Box, find_faces, read_photo, segment_skin

FACE = Box(176, 71, 268, 163)


def test_skin_is_skin_and_the_rest_is_not(astronaut: np.ndarray) -> None:
    mask = segment_skin(astronaut, FACE)
    assert mask.shape == (512, 512) and mask.dtype == np.float32
    assert mask.min() >= 0 and mask.max() <= 1
    cheeks_and_nose = [(135, 200), (135, 245), (125, 224), (90, 210)]
    elsewhere = [(60, 180), (40, 230), (300, 200), (450, 380), (100, 204), (145, 225)]
    assert all(mask[place] > 0.8 for place in cheeks_and_nose)
    assert all(mask[place] < 0.2 for place in elsewhere)


def test_the_mask_follows_the_picture_mirrored(astronaut: np.ndarray) -> None:
    mirrored = Box(512 - FACE.right, FACE.top, 512 - FACE.left, FACE.bottom)
    there = segment_skin(astronaut[:, ::-1], mirrored)[:, ::-1]
    assert np.abs(there - segment_skin(astronaut, FACE)).mean() < 0.01


@given(
    photo=hnp.arrays(np.uint8, st.tuples(st.integers(1, 30), st.integers(1, 30), st.just(3))),
    left=st.integers(-40, 40),
    top=st.integers(-40, 40),
    side=st.integers(1, 50),
)
def test_a_mask_is_made_of_anything(photo: np.ndarray, left: int, top: int, side: int) -> None:
    mask = segment_skin(photo, Box(left, top, left + side, top + side))
    assert mask.shape == photo.shape[:2]
    assert mask.min() >= 0 and mask.max() <= 1


def test_masks_hold_the_cheeks_and_neither_eyes_nor_mouth(shared_data: Path) -> None:
    cheeks, pupils_and_mouth = (165, 168), (0, 1, 101)
    for path in sorted((shared_data / "faces" / "london").glob("*.jpg"))[::9]:
        photo = read_photo(path)
        face = find_faces(photo)[0].box
        assert face is not None, path.name
        mask = segment_skin(photo, face)
        landmarks = np.loadtxt(path.with_suffix(".tem"), skiprows=1, max_rows=189).astype(int)
        at = {index: mask[landmarks[index, 1], landmarks[index, 0]] for index in range(189)}
        assert min(at[index] for index in cheeks) > 0.9, path.name
        assert np.mean([at[index] for index in pupils_and_mouth]) < 0.2, path.name
