import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from skimage import data

from skinnet.images import Box, as_photo, find_face, frame_head, read_photo, resize, segment_skin

FACE = Box(176, 71, 268, 163)


def overlap(a: Box, b: Box) -> float:
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.bottom, b.bottom) - max(a.top, b.top)
    shared = max(width, 0) * max(height, 0)
    return shared / (a.width * a.height + b.width * b.height - shared)


def test_the_astronaut_is_found(astronaut: np.ndarray) -> None:
    face = find_face(astronaut)
    assert face is not None
    assert overlap(face, FACE) > 0.7


@pytest.mark.parametrize("factor", [0.5, 4])
def test_a_face_is_found_at_any_size(astronaut: np.ndarray, factor: float) -> None:
    side = round(512 * factor)
    face = find_face(resize(astronaut, side, side))
    assert face is not None
    assert overlap(face, Box(*(round(value * factor) for value in FACE))) > 0.6


def test_the_largest_central_face_is_taken(astronaut: np.ndarray) -> None:
    small = resize(astronaut, 256, 256)
    scene = np.full((512, 768, 3), 128, np.uint8)
    scene[:256, :256], scene[:, 256:] = small, astronaut
    face = find_face(scene)
    assert face is not None
    assert overlap(face, Box(FACE.left + 256, FACE.top, FACE.right + 256, FACE.bottom)) > 0.6


@pytest.mark.parametrize("shape", [(1, 1), (3, 900), (40, 30), (300, 400)])
def test_no_face_is_none(shape: tuple[int, int]) -> None:
    assert find_face(np.full((*shape, 3), 200, np.uint8)) is None


@pytest.mark.parametrize("name", ["coffee", "rocket", "brick", "gravel", "coins", "moon"])
def test_no_face_is_seen_in_things(name: str) -> None:
    assert find_face(as_photo(getattr(data, name)())) is None


@pytest.mark.parametrize("side", [200, 1000])
def test_no_face_is_seen_in_noise(side: int) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (side, side, 3), np.uint8)
    assert find_face(noise) is None


def test_the_crop_is_square_and_holds_the_head() -> None:
    crop = frame_head(FACE, 512, 512)
    assert crop.width == crop.height == 184
    # Hair starts a fifth of a face above the box, and the chin ends just under it.
    assert crop.top < FACE.top - 0.2 * 92 and crop.bottom > FACE.bottom + 0.1 * 92


def test_the_crop_stays_inside_the_picture() -> None:
    assert frame_head(Box(-3, -2, 90, 91), 100, 80) == Box(0, 0, 100, 80)


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


def test_portraits_are_found(shared_data: Path) -> None:
    folder = shared_data / "faces" / "congress"
    with (folder / "index.csv").open() as file:
        rows = list(csv.DictReader(file))[::20]
    found = 0
    for row in rows:
        x, y, width, height = (int(row[f"face_{key}"]) for key in "xywh")
        face = find_face(read_photo(folder / row["file"]))
        found += face is not None and overlap(face, Box(x, y, x + width, y + height)) > 0.4
    assert found >= 0.95 * len(rows)


def test_masks_hold_the_cheeks_and_neither_eyes_nor_mouth(shared_data: Path) -> None:
    cheeks, pupils_and_mouth = (165, 168), (0, 1, 101)
    for path in sorted((shared_data / "faces" / "london").glob("*.jpg"))[::9]:
        photo = read_photo(path)
        face = find_face(photo)
        assert face is not None, path.name
        mask = segment_skin(photo, face)
        landmarks = np.loadtxt(path.with_suffix(".tem"), skiprows=1, max_rows=189).astype(int)
        at = {index: mask[landmarks[index, 1], landmarks[index, 0]] for index in range(189)}
        assert min(at[index] for index in cheeks) > 0.9, path.name
        assert np.mean([at[index] for index in pupils_and_mouth]) < 0.2, path.name
